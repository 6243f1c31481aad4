// SPDX-License-Identifier: BSD-3-Clause
#include "shared/output_file.h"

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

void remove_partial_files_and_end(int signal) {
  remove_partial_files();
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

/// Returns where a result will be, all links followed.
std::filesystem::path target_of(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::path target = follow_links(path, error);
  if (error) throw Error(path.string() + ": its links lead in a circle");
  return target;
}

std::string failure_of(const std::error_code& error) {
  const bool is_folder = error == std::errc::is_a_directory;
  if (!is_folder && error != std::errc::file_exists) {
    return "cannot write here (" + error.message() + "); does the folder exist, and is it yours?";
  }
  return std::string(is_folder ? "is a folder" : "is a pipe, a socket or a device") +
         "; results are written to a regular file only, so give the name of one";
}

/// One name for each file, also for one that does not exist.
std::filesystem::path unique_name(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(target_of(path), error);
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

void remove_partial_files() noexcept {
  for (const PartialFile& file : partial_files) {
    if (file.exists) ::unlink(file.path.data());
  }
}

RemovedBySignals::RemovedBySignals(std::filesystem::path path) : path_(std::move(path)) {
  handle_signals();
  const std::string name = path_.string();
  for (PartialFile& file : partial_files) {
    if (file.exists || name.size() >= file.path.size()) continue;
    std::copy_n(name.c_str(), name.size() + 1, file.path.begin());
    file.exists = true;
    return;
  }
}

RemovedBySignals::~RemovedBySignals() {
  for (PartialFile& file : partial_files) {
    if (file.exists && path_ == file.path.data()) file.exists = false;
  }
}

OutputFile::OutputFile(const std::filesystem::path& path)
    : partial_(target_of(path).string() + ".partial-" + std::to_string(::getpid())),
      file_(path, partial_.path()),
      path_(path) {
  if (file_.error()) throw Error(path_.string() + ": " + failure_of(file_.error()));
}

void OutputFile::finish() {
  if (!file_.finish()) return;
  throw Error(path_.string() + ": could not be written to the end; is the disk full?");
}

void OutputFile::commit() {
  finish();
  const std::error_code error = file_.commit();
  if (error) throw Error(path_.string() + ": cannot be replaced (" + error.message() + ")");
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
