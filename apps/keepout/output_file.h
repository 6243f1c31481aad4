// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <list>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace keepout::app {

/// A file that appears only when it is whole: written beside its place under another name, and
/// moved there by commit(). Left without a commit, nothing remains, and what stood there before
/// still stands; so it is, too, when SIGHUP, SIGINT, SIGPIPE or SIGTERM end the process meanwhile.
///
/// A link is followed: what it points to is replaced, the link stays. Not thread-safe: one thread
/// makes and ends all of them.
class OutputFile {
 public:
  /// Throws Error when the file cannot be made, and when something else than a regular file stands
  /// there: a folder, a device, a pipe.
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() noexcept { return stream_; }

  /// Ends the writing. Throws Error when something could not be written, a full disk for one. Of
  /// several files that belong together, finish() all before the commit() of any.
  void finish();

  /// Finishes, and moves the file to its place. Throws Error when either cannot be done.
  void commit();

 private:
  std::filesystem::path path_;  // where it will stand, links followed
  std::filesystem::path partial_;
  std::ofstream stream_;
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
