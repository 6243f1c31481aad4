// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <initializer_list>
#include <list>
#include <optional>
#include <ostream>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "keepout/file_replacement.h"
#include "shared/open_file.h"

namespace keepout::app {

/// Removes all partial files. For signal handlers: calls only what POSIX names async-signal-safe.
void remove_partial_files() noexcept;

/// The name of a partial file, which SIGHUP, SIGINT, SIGPIPE and SIGTERM remove when they end the
/// process. Not thread-safe.
class RemovedBySignals {
 public:
  explicit RemovedBySignals(std::filesystem::path path);
  ~RemovedBySignals();
  RemovedBySignals(const RemovedBySignals&) = delete;
  RemovedBySignals& operator=(const RemovedBySignals&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

/// A file that replaces another when commit() is called, or a text that commit() appends to an
/// open file. Without a commit nothing remains, and the old file stays, also if SIGHUP, SIGINT,
/// SIGPIPE or SIGTERM ends the process before. Not thread-safe: one thread makes and ends all of
/// them.
class OutputFile {
 public:
  /// Throws Error if the file cannot be made, or would replace a directory, a device or a pipe. A
  /// path for which entry_of_open_file() returns an entry replaces nothing: see OpenFile.
  explicit OutputFile(const std::filesystem::path& path);

  std::ostream& stream() noexcept;

  /// Ends the writing, and moves the file to its place or appends the text. Throws Error if that
  /// fails.
  void commit();

  /// Returns the name for messages: the path as the user gave it, or "stdout" for "-".
  const std::string& name() const noexcept { return name_; }

 private:
  /// Throws Error, naming the file, because it could not be written to the end.
  [[noreturn]] void fail(const std::error_code& error) const;

  std::string name_;
  std::optional<OpenFile> open_;  // if set, the two below are not
  std::optional<RemovedBySignals> partial_;
  std::optional<FileReplacement> file_;
  std::ostringstream text_;  // for open_
};

/// A path, and what the user calls it: MESH, --out.
struct NamedPath {
  std::string_view name;
  std::filesystem::path path;
};

/// The files that a command was asked for, made before any work: what cannot be written shall not
/// be told of after an hour.
class OutputFiles {
 public:
  /// What the user calls a file, and its path if he asked for it.
  using Asked = std::pair<std::string_view, std::optional<std::filesystem::path>>;

  /// Throws Error where OutputFile does, and, naming both, when an output is the same file as an
  /// input or as another output, by whatever names and links, and whether or not it exists yet.
  OutputFiles(std::span<const NamedPath> inputs, std::initializer_list<Asked> outputs);

  /// Where to write; null where it was not asked for.
  std::ostream* stream(std::string_view name);

  /// Commits each file of which the stream was asked for. If some cannot be written, commits the
  /// others all the same, and then throws Error, naming both. Files whose stream was not asked for
  /// may follow later.
  void commit();

 private:
  struct Output {
    Output(std::string_view called, const std::filesystem::path& path) : name(called), file(path) {}

    std::string_view name;
    OutputFile file;
    bool is_written = false;
  };
  std::list<Output> outputs_;
};

}  // namespace keepout::app
