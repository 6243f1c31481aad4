// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "output_file.h"

#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>

#include "keepout/error.h"

namespace keepout::app {

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)),
      partial_(path_.string() + ".partial-" + std::to_string(::getpid())),
      stream_(partial_, std::ios::binary) {
  if (!stream_) {
    throw Error(path_.string() + ": cannot write here; does the folder exist, and is it yours?");
  }
}

OutputFile::~OutputFile() {
  if (partial_.empty()) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void OutputFile::commit() {
  stream_.close();
  std::error_code error;
  if (stream_) std::filesystem::rename(partial_, path_, error);
  if (!stream_ || error) {
    throw Error(path_.string() + ": could not be written to the end" +
                (error ? " (" + error.message() + ")" : "; is the disk full?"));
  }
  partial_.clear();
}

}  // namespace keepout::app
