// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/module.h"

#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "keepout/version.h"

#ifndef __EMSCRIPTEN__
#include <dlfcn.h>
#endif

namespace keepout {

#ifdef __EMSCRIPTEN__  // web pages have no modules

bool has_module(const char*) { return false; }
const void* table_in_module(const char*, const char*) { return nullptr; }

#else

namespace {

namespace fs = std::filesystem;

/// Returns the directories of the program and of the library that contains this function.
std::vector<fs::path> own_folders() {
  std::vector<fs::path> folders;
  std::error_code error;
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&has_module), &info) != 0) {
    folders.push_back(fs::canonical(info.dli_fname, error).parent_path());
  }
  folders.push_back(fs::canonical("/proc/self/exe", error).parent_path());
  return folders;
}

/// Returns the file of a module; empty if it is absent.
fs::path file_of(const char* module) {
  std::error_code error;
  if (std::string_view(module).find('/') != std::string_view::npos) {  // a plugin
    return fs::is_regular_file(module, error) ? fs::path(module) : fs::path();
  }
  const std::string name = std::string(module) + ".so";
  if (const char* const named = std::getenv("KEEPOUT_MODULES");
      named != nullptr && *named != '\0') {
    const fs::path file = fs::path(named) / name;
    return fs::is_regular_file(file, error) ? file : fs::path();
  }
  static const std::vector<fs::path> folders = own_folders();
  for (const fs::path& folder : folders) {
    if (folder.empty()) continue;
    for (const char* const place : {".", "..", "../..", "../lib", "../" KEEPOUT_LIBRARY_FOLDER}) {
      const fs::path file = folder / place / "keepout-modules" / name;
      if (fs::is_regular_file(file, error)) return file;
    }
  }
  return {};
}

/// Returns the handle of a loaded module; null if its file is absent. Throws Error.
void* load(const char* module) {
  const fs::path file = file_of(module);
  if (file.empty()) return nullptr;
  // Never unloaded, because the program holds its functions.
  void* const handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) {
    throw Error("the module " + file.string() + " cannot be loaded: " + dlerror());
  }
  const auto* const version = static_cast<const char*>(dlsym(handle, "keepout_module_version"));
  if (version == nullptr || std::string_view(version) != KEEPOUT_VERSION) {
    throw Error("the module " + file.string() + " belongs to " +
                (version == nullptr ? "no version of keepout (has it KEEPOUT_MODULE()?)"
                                    : "keepout " + std::string(version)) +
                ", and this is keepout " + KEEPOUT_VERSION + "; install the same version of both");
  }
  return handle;
}

}  // namespace

bool has_module(const char* module) { return !file_of(module).empty(); }

const void* table_in_module(const char* module, const char* table) {
  static std::mutex mutex;
  static std::map<std::string, void*, std::less<> > loaded;
  const std::scoped_lock lock(mutex);
  const auto found = loaded.find(std::string_view(module));
  void* const handle = found == loaded.end() ? load(module) : found->second;
  if (handle == nullptr) return nullptr;  // searched again next time, as it may be installed
  loaded.emplace(module, handle);
  return dlsym(handle, table);
}

#endif

}  // namespace keepout
