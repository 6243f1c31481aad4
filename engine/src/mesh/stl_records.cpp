// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stl_records.h"

#include <string>

#include "keepout/error.h"
#include "keepout/ids.h"

namespace keepout {

constexpr std::size_t preamble_size = stl_header_size + sizeof(std::uint32_t);

std::optional<std::uint32_t> declared_triangles(const ReadOnlyFile& file) {
  std::uint32_t count;
  if (!file.read(stl_header_size, &count, sizeof count)) return std::nullopt;
  if (file.size() != preamble_size + stl_record_size * std::uint64_t{count}) return std::nullopt;
  return count;
}

StlRecords::StlRecords(const std::filesystem::path& path) : path_(path), file_(path), count_(0) {
  if (!file_.is_open()) fail("cannot be opened; check the name and the permissions");
  const std::optional<std::uint32_t> count = declared_triangles(file_);
  if (!count) {
    fail("not a binary STL file, or cut short: its length does not agree with its header");
  }
  if (*count == 0) fail("has no triangles; check the export");
  // Three vertices for each triangle must be countable.
  if (*count > no_triangle / 3) fail("has too many triangles to read; split or decimate it");
  count_ = *count;
}

void StlRecords::read(std::size_t first, std::size_t count, std::vector<char>& records) const {
  records.resize(count * stl_record_size);
  if (!file_.read(preamble_size + stl_record_size * std::uint64_t{first}, records.data(),
                  records.size())) {
    fail("cannot be read to its end; check the disk");
  }
}

void StlRecords::refuse(std::size_t triangle) const {
  fail("triangle " + std::to_string(triangle) +
       " has a coordinate that is not finite; repair the mesh and export it again");
}

void StlRecords::fail(const std::string& what) const { throw Error(path_.string() + ": " + what); }

}  // namespace keepout
