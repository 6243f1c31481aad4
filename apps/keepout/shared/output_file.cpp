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
#include "shared/names.h"

namespace keepout::app {
namespace {

/// The name of a partial file, which a signal handler can read: it uses no heap memory and no lock.
struct PartialFile {
  std::atomic<bool> exists = false;  // or is about to exist
  std::array<char, 4096> path;       // zero-terminated
};
static_assert(std::atomic<bool>::is_always_lock_free);

// A command has at most three. A file without a free entry would only remain after a signal.
std::array<PartialFile, 8> partial_files;

void remove_partial_files_and_end(int signal) {
  remove_partial_files();
  ::signal(signal, SIG_DFL);
  ::raise(signal);  // delivered when this function returns
}

void handle_signals() {
  for (const int signal : {SIGHUP, SIGINT, SIGPIPE, SIGTERM}) {
    struct sigaction action = {};
    // A signal that is ignored, for example by nohup, or handled elsewhere stays so.
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;
    action.sa_handler = remove_partial_files_and_end;
    ::sigaction(signal, &action, nullptr);
  }
}

/// Returns the path of a result, with all links followed.
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

/// Returns one unique name for each file, even for a file that does not exist.
std::filesystem::path unique_name(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(target_of(path), error);
  const std::filesystem::path unique = std::filesystem::weakly_canonical(absolute, error);
  return error ? path : unique;
}

/// Returns true if an output would overwrite another file. A pipe or a terminal that is open twice,
/// as stdin and as stdout, cannot be overwritten.
bool same_file(const std::filesystem::path& output, const std::filesystem::path& other) {
  const auto one = entry_of_open_file(output);
  const auto two = entry_of_open_file(other);
  if (one && one == two) return true;
  const std::filesystem::path& first = one ? *one : output;
  const std::filesystem::path& second = two ? *two : other;
  std::error_code missing;  // equivalent() finds hard links only if both files exist
  if (one && !std::filesystem::is_regular_file(first, missing)) return false;
  return std::filesystem::equivalent(first, second, missing) ||
         unique_name(first) == unique_name(second);
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
    : name_(path == "-" ? "stdout" : path.string()) {
  if (const auto entry = entry_of_open_file(path)) {
    open_.emplace(*entry);
    if (!open_->error()) return;
    throw Error(name_ + ": is not open for writing (" + open_->error().message() +
                "); name a file, or connect it");
  }
  partial_.emplace(target_of(path).string() + ".partial-" + std::to_string(::getpid()));
  file_.emplace(path, partial_->path());
  if (file_->error()) throw Error(name_ + ": " + failure_of(file_->error()));
}

std::ostream& OutputFile::stream() noexcept {
  if (file_) return file_->stream();
  return text_;
}

void OutputFile::fail(const std::error_code& error) const {
  throw Error(name_ + ": could not be written to the end; " +
              (error == std::errc::broken_pipe ? "its reader has ended" : "is the disk full?"));
}

void OutputFile::commit() {
  if (open_) {
    if (const std::error_code error = open_->write(std::exchange(text_, {}).view())) fail(error);
    return;
  }
  if (const std::error_code error = file_->finish()) fail(error);
  const std::error_code error = file_->commit();
  if (error) throw Error(name_ + ": cannot be replaced (" + error.message() + ")");
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
  std::vector<std::string> faults, written;
  for (Output& output : outputs_) {
    if (!output.is_written) continue;
    try {
      output.file.commit();
      written.push_back(output.file.name());
    } catch (const Error& error) {
      faults.emplace_back(error.what());
    }
  }
  if (faults.empty()) return;
  throw Error(enumerated(faults, "; ") +
              (written.empty() ? "" : " (these were written: " + enumerated(written) + ")"));
}

}  // namespace keepout::app
