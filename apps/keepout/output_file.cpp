// SPDX-License-Identifier: BSD-3-Clause
#include "output_file.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <string>
#include <system_error>
#include <vector>

#include "keepout/error.h"

namespace keepout::app {
namespace {

/// A partial file, where a signal handler can read of it: no memory of the heap, no lock.
struct PartialFile {
  std::atomic<bool> exists = false;  // or is about to
  std::array<char, 4096> path;       // ends with a zero
};
static_assert(std::atomic<bool>::is_always_lock_free);

// A command has three at most. One that found no room would merely outlive a signal.
std::array<PartialFile, 8> partial_files;

/// Calls nothing but what POSIX calls async-signal-safe.
void remove_partial_files_and_end(int signal) {
  for (const PartialFile& file : partial_files) {
    if (file.exists) ::unlink(file.path.data());
  }
  ::signal(signal, SIG_DFL);
  ::raise(signal);  // delivered when this returns
}

void handle_signals() {
  for (const int signal : {SIGHUP, SIGINT, SIGPIPE, SIGTERM}) {
    struct sigaction action = {};
    // Whoever had it ignored, nohup for one, or handles it otherwise, is right.
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;
    action.sa_handler = remove_partial_files_and_end;
    ::sigaction(signal, &action, nullptr);
  }
}

void remember(const std::string& path) {
  handle_signals();
  for (PartialFile& file : partial_files) {
    if (file.exists || path.size() >= file.path.size()) continue;
    std::copy_n(path.c_str(), path.size() + 1, file.path.begin());
    file.exists = true;
    return;
  }
}

void forget(std::string_view path) {
  for (PartialFile& file : partial_files) {
    if (file.exists && path == file.path.data()) file.exists = false;
  }
}

/// What a path leads to when all links are followed, even when nothing is there yet.
std::filesystem::path follow_links(std::filesystem::path path) {
  std::error_code none;
  for (int links = 0; std::filesystem::is_symlink(path, none); ++links) {
    if (links == 40) throw Error(path.string() + ": its links lead in a circle");
    // An absolute target takes the place of the whole.
    path = path.parent_path() / std::filesystem::read_symlink(path);
  }
  return path;
}

void require_regular_or_nothing(const std::filesystem::path& path) {
  using std::filesystem::file_type;
  std::error_code none;
  const file_type type = std::filesystem::status(path, none).type();
  const char* kind = type == file_type::directory   ? "a folder"
                     : type == file_type::fifo      ? "a pipe"
                     : type == file_type::socket    ? "a socket"
                     : type == file_type::block     ? "a device"
                     : type == file_type::character ? "a device"
                                                    : nullptr;
  if (kind != nullptr) {
    throw Error(path.string() + ": is " + kind +
                "; results are written to a regular file only, so give the name of one");
  }
}

/// One name for each file, also for one that does not exist.
std::filesystem::path unique_name(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(follow_links(path), error);
  const std::filesystem::path unique = std::filesystem::weakly_canonical(absolute, error);
  return error ? path : unique;
}

bool same_file(const std::filesystem::path& one, const std::filesystem::path& other) {
  std::error_code missing;  // hard links need both to exist
  return std::filesystem::equivalent(one, other, missing) || unique_name(one) == unique_name(other);
}

void refuse_if_same(const NamedPath& output, const NamedPath& other) {
  if (!same_file(output.path, other.path)) return;
  throw Error(std::string(output.name) + " '" + output.path.string() + "' is the same file as " +
              std::string(other.name) + " '" + other.path.string() +
              "' and would overwrite it; choose another name for " + std::string(output.name));
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) {
  require_regular_or_nothing(path);
  path_ = follow_links(path);
  partial_ = path_.string() + ".partial-" + std::to_string(::getpid());
  remember(partial_.string());
  if (!path_.filename().empty()) stream_.open(partial_, std::ios::binary);
  if (!stream_.is_open()) {
    forget(partial_.string());
    throw Error(path.string() + ": cannot write here; does the folder exist, and is it yours?");
  }
}

OutputFile::~OutputFile() {
  if (partial_.empty()) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
  forget(partial_.string());
}

void OutputFile::finish() {
  if (stream_.is_open()) stream_.close();
  if (!stream_) {
    throw Error(path_.string() + ": could not be written to the end; is the disk full?");
  }
}

void OutputFile::commit() {
  if (partial_.empty()) return;  // it is there
  finish();
  std::error_code error;
  std::filesystem::rename(partial_, path_, error);
  if (error) throw Error(path_.string() + ": cannot be replaced (" + error.message() + ")");
  forget(partial_.string());
  partial_.clear();
}

OutputFiles::OutputFiles(std::span<const NamedPath> inputs, std::initializer_list<Asked> outputs) {
  std::vector<NamedPath> paths(inputs.begin(), inputs.end());
  for (const auto& [name, path] : outputs) {
    if (!path) continue;
    for (const NamedPath& other : paths) refuse_if_same({name, *path}, other);
    paths.push_back({name, *path});
  }
  for (const auto& [name, path] : std::span(paths).subspan(inputs.size())) {
    outputs_.emplace_back(name, path);
  }
}

std::ostream* OutputFiles::stream(std::string_view name) {
  const auto output = std::ranges::find(outputs_, name, &Output::name);
  if (output == outputs_.end()) return nullptr;
  output->is_written = true;
  return &output->file.stream();
}

void OutputFiles::commit() {
  for (Output& output : outputs_) {
    if (output.is_written) output.file.finish();
  }
  for (Output& output : outputs_) {
    if (output.is_written) output.file.commit();
  }
}

}  // namespace keepout::app
