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

/// Removes all partial files. May be called by signal handlers: it uses only functions that POSIX
/// calls async-signal-safe.
void remove_partial_files() noexcept;

/// The name of a partial file. SIGHUP, SIGINT, SIGPIPE and SIGTERM remove the file when they end
/// the process. Not thread-safe.
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

/// A file that replaces another one when commit() is called, or a text that commit() appends to an
/// open file. Without a commit nothing remains and the old file stays, even if SIGHUP, SIGINT,
/// SIGPIPE or SIGTERM ends the process. Not thread-safe: one thread must create and destroy all of
/// them.
class OutputFile {
 public:
  /// Throws Error if the file cannot be created, or would replace a directory, a device or a pipe.
  /// A path for which entry_of_open_file() returns an entry replaces nothing: see OpenFile.
  explicit OutputFile(const std::filesystem::path& path);

  std::ostream& stream() noexcept;

  /// Ends the writing, and moves the file to its place or appends the text. Throws Error if that
  /// fails.
  void commit();

  /// Returns the name for messages: the path as the user gave it, or "stdout" for "-".
  const std::string& name() const noexcept { return name_; }

 private:
  /// Throws Error with the name of the file, because it could not be written completely.
  [[noreturn]] void fail(const std::error_code& error) const;

  std::string name_;
  std::optional<OpenFile> open_;  // if set, the next two are empty
  std::optional<RemovedBySignals> partial_;
  std::optional<FileReplacement> file_;
  std::ostringstream text_;  // the text for open_
};

/// A path, and its name on the command line: MESH, --out.
struct NamedPath {
  std::string_view name;
  std::filesystem::path path;
};

/// The files that a command must write. They are opened before any work, so that an unwritable file
/// is reported at once and not after an hour.
class OutputFiles {
 public:
  /// The name of a file on the command line, and its path if the user gave one.
  using Asked = std::pair<std::string_view, std::optional<std::filesystem::path>>;

  /// Throws Error as OutputFile does. Also throws Error, with both names, if an output is the same
  /// file as an input or another output. Names, links and missing files make no difference.
  OutputFiles(std::span<const NamedPath> inputs, std::initializer_list<Asked> outputs);

  /// Returns the stream to write to; null if the file was not requested.
  std::ostream* stream(std::string_view name);

  /// Commits each file whose stream was requested. If some cannot be written, commits the others,
  /// and then throws Error with the names of both. The other files may be committed later.
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
