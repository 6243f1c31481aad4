// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <initializer_list>
#include <list>
#include <optional>
#include <ostream>
#include <span>
#include <string_view>
#include <utility>

#include "keepout/file_replacement.h"

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

/// A file that replaces another when commit() is called. Without a commit nothing remains, and the
/// old file stays, also if SIGHUP, SIGINT, SIGPIPE or SIGTERM ends the process before. Not
/// thread-safe: one thread makes and ends all of them.
class OutputFile {
 public:
  /// Throws Error if the file cannot be made, or would replace a directory, a device or a pipe.
  explicit OutputFile(const std::filesystem::path& path);

  std::ostream& stream() noexcept { return file_.stream(); }

  /// Ends the writing. Throws Error if a write failed. Of several files that belong together,
  /// finish() all before the commit() of any.
  void finish();

  /// Finishes, and moves the file to its place. Throws Error if either fails.
  void commit();

 private:
  RemovedBySignals partial_;
  FileReplacement file_;
  std::filesystem::path path_;  // as the user gave it
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

  /// Moves to their places those of which the stream was asked for, once all of them are whole.
  /// Throws Error when one cannot be. The others may follow later.
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
