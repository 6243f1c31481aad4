// SPDX-License-Identifier: BSD-3-Clause
#include "vtp_document.h"

#include <expat.h>

#include <algorithm>
#include <charconv>
#include <exception>
#include <memory>
#include <string_view>
#include <utility>

#include "keepout/error.h"
#include "text_lines.h"

namespace keepout {
namespace {

using namespace std::string_view_literals;

constexpr const char* cut_short = "; the file is damaged, or was cut short";

/// Receives the elements of the document from Expat.
class VtpListener {
 public:
  VtpListener(const MeshSource& source, XML_Parser parser) : source_(source), parser_(parser) {
    XML_SetUserData(parser, this);
    XML_SetElementHandler(
        parser,
        [](void* self, const char* name, const char** attributes) {
          static_cast<VtpListener*>(self)->attempt(
              [&](VtpListener& of) { of.start_element(name, attributes); });
        },
        [](void* self, const char*) {
          static_cast<VtpListener*>(self)->attempt([](VtpListener& of) { of.end_element(); });
        });
  }

  VtpDocument read() {
    constexpr std::uint64_t at_once = std::uint64_t{1} << 20;
    std::vector<char> part(static_cast<std::size_t>(std::min(at_once, source_.size())));
    for (std::uint64_t at = 0; at < source_.size() && !is_done_; at += part.size()) {
      part.resize(static_cast<std::size_t>(std::min(at_once, source_.size() - at)));
      source_.read(at, part.data(), part.size());
      const bool is_last = at + part.size() == source_.size();
      const XML_Status status =
          XML_Parse(parser_, part.data(), static_cast<int>(part.size()), is_last ? 1 : 0);
      if (failure_) std::rethrow_exception(failure_);
      if (status == XML_STATUS_ERROR && !is_done_) {
        fail(std::string("XML that is not well-formed, ") +
             XML_ErrorString(XML_GetErrorCode(parser_)) + cut_short);
      }
    }
    if (document_.pieces.empty()) source_.fail("has no Piece of PolyData; check the export");
    if (document_.appended > 0) find_appended_data();
    return std::move(document_);
  }

 private:
  using Attributes = const char**;

  /// No exception may pass through Expat, which is C.
  template <class Work>
  void attempt(const Work& work) noexcept {
    if (failure_) return;
    try {
      work(*this);
    } catch (...) {
      failure_ = std::current_exception();
      XML_StopParser(parser_, XML_FALSE);
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    source_.fail("line " + std::to_string(XML_GetCurrentLineNumber(parser_)) + ": " + what);
  }

  std::uint64_t position() const {
    return static_cast<std::uint64_t>(std::max<XML_Index>(0, XML_GetCurrentByteIndex(parser_)));
  }
  std::uint64_t end_of_tag() const {
    return position() + static_cast<std::uint64_t>(XML_GetCurrentByteCount(parser_));
  }

  static std::string_view attribute(Attributes attributes, std::string_view name) {
    for (; attributes[0] != nullptr; attributes += 2) {
      if (attributes[0] == name) return attributes[1];
    }
    return {};
  }

  /// Returns the value of an attribute, or 0 if it is missing.
  std::uint64_t count(Attributes attributes, std::string_view name) const {
    const std::string_view text = attribute(attributes, name);
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (!text.empty() && (error != std::errc{} || end != text.data() + text.size())) {
      fail(std::string(name) + " must be a whole number, not " + in_quotes(text) + cut_short);
    }
    if (value > most_unpacked * source_.size()) {
      fail(std::string(name) + " is " + std::string(text) + ", more than the file has room for" +
           cut_short);
    }
    return value;
  }

  void start_element(std::string_view name, Attributes attributes) {
    end_array();  // an array may have elements after its numbers
    if (parents_.empty()) {
      start_file(name, attributes);
    } else if (name == "Piece") {
      VtpPiece& piece = document_.pieces.emplace_back();
      piece.points = count(attributes, "NumberOfPoints");
      piece.polygons.count = count(attributes, "NumberOfPolys");
      piece.strips.count = count(attributes, "NumberOfStrips");
      piece.left_out = count(attributes, "NumberOfVerts") + count(attributes, "NumberOfLines");
    } else if (name == "DataArray" || name == "Array") {
      start_array(attributes);
    } else if (name == "AppendedData") {
      document_.is_raw = attribute(attributes, "encoding") == "raw";
      document_.appended = end_of_tag();
      is_done_ = true;
      XML_StopParser(parser_, XML_FALSE);
    }
    parents_.emplace_back(name);
  }

  void start_file(std::string_view name, Attributes attributes) {
    const std::string_view type = attribute(attributes, "type");
    if (name != "VTKFile") {
      fail("expected 'VTKFile', found " + in_quotes(name) +
           "; if the file has another format, give it that extension");
    }
    if (type != "PolyData") {
      fail("a VTKFile of " + in_quotes(type) +
           ", and only PolyData is a surface; extract the surface and save that");
    }
    const std::string_view order = attribute(attributes, "byte_order");
    if (!order.empty() && order != "LittleEndian" && order != "BigEndian") {
      fail("byte_order must be LittleEndian or BigEndian, not " + in_quotes(order) + cut_short);
    }
    document_.is_big_endian = order == "BigEndian";
    const std::string_view counts = attribute(attributes, "header_type");
    if (!counts.empty() && counts != "UInt32" && counts != "UInt64") {
      fail("header_type must be UInt32 or UInt64, not " + in_quotes(counts) + cut_short);
    }
    document_.count_size = counts == "UInt64" ? 8 : 4;
    const std::string_view compressor = attribute(attributes, "compressor");
    document_.is_compressed = !compressor.empty();
    if (document_.is_compressed && compressor != "vtkZLibDataCompressor") {
      fail("is compressed by " + in_quotes(compressor) +
           ", and only zlib is read; save it without compression, or with zlib");
    }
  }

  /// Adds an array to the document. Returns nullptr if the array is not needed.
  VtpArray* add_array(std::string_view name, std::string_view type) {
    const std::string_view parent = parents_.back();
    if (parent == "FieldData") {
      const bool is_space = lower(name) == "space" && type == "String";
      return is_space ? &document_.spaces.emplace_back() : nullptr;
    }
    if (document_.pieces.empty()) return nullptr;
    VtpPiece& piece = document_.pieces.back();
    if (parent == "Points") return add_once(name, piece.coordinates);
    if (parent != "Polys" && parent != "Strips") return nullptr;
    VtpCellArrays& cells = parent == "Polys" ? piece.polygons : piece.strips;
    return name == "offsets"        ? add_once(name, cells.ends)
           : name == "connectivity" ? add_once(name, cells.corners)
                                    : nullptr;
  }

  VtpArray* add_once(std::string_view name, std::optional<VtpArray>& place) const {
    if (place) fail("the array " + in_quotes(name) + " is there twice; check the export");
    return &place.emplace();
  }

  void start_array(Attributes attributes) {
    const std::string_view name = attribute(attributes, "Name");
    const std::string_view type = attribute(attributes, "type");
    VtpArray* const added = add_array(name, type);
    if (added == nullptr) return;
    const std::string_view components = attribute(attributes, "NumberOfComponents");
    if (parents_.back() == "Points" && !components.empty() && components != "3") {
      fail("points have 3 components, not " + in_quotes(components) + "; check the export");
    }
    VtpArray& array = *added;
    array.name = parents_.back() + " " + std::string(name);
    array.type = type;
    const std::string_view format = attribute(attributes, "format");
    if (format == "appended") {
      array.format = VtpArray::Format::appended;
      array.begin = count(attributes, "offset");
      return;
    }
    if (!format.empty() && format != "ascii" && format != "binary") {
      fail("the format of an array must be ascii, binary or appended, not " + in_quotes(format));
    }
    array.format = format == "binary" ? VtpArray::Format::base64 : VtpArray::Format::text;
    array.begin = end_of_tag();
    array.line = static_cast<std::size_t>(XML_GetCurrentLineNumber(parser_));
    open_ = &array;
  }

  void end_element() {
    end_array();
    parents_.pop_back();
  }

  void end_array() {
    if (open_ != nullptr) open_->end = std::max(open_->begin, position());
    open_ = nullptr;
  }

  /// Finds the appended data, which begin after the first underscore. Checks that the end of the
  /// file is there.
  void find_appended_data() {
    constexpr std::uint64_t blanks = 64;
    const std::uint64_t ending = std::min(blanks, source_.size());
    std::string end(static_cast<std::size_t>(ending), '\0');
    source_.read(source_.size() - ending, end.data(), end.size());
    if (end.find("</VTKFile>") == std::string::npos) {
      source_.fail("does not end with </VTKFile>, so it was cut short; copy or export it again");
    }
    std::string text(
        static_cast<std::size_t>(std::min(blanks, source_.size() - document_.appended)), '\0');
    source_.read(document_.appended, text.data(), text.size());
    const std::size_t underscore = text.find_first_not_of(" \t\r\n");
    if (underscore == std::string::npos || text[underscore] != '_') {
      source_.fail("its appended data do not begin with '_'" + std::string(cut_short));
    }
    document_.appended += underscore + 1;
  }

  const MeshSource& source_;
  XML_Parser parser_;
  VtpDocument document_;
  std::vector<std::string> parents_;  // of the present element
  VtpArray* open_ = nullptr;          // the array whose numbers are being read
  bool is_done_ = false;
  std::exception_ptr failure_;
};

}  // namespace

VtpDocument read_vtp_document(const MeshSource& source) {
  const std::string beginning = source.contents(2);
  for (const std::string_view utf16 : {"\xFE\xFF"sv, "\xFF\xFE"sv, "<\0"sv, "\0<"sv}) {
    if (beginning == utf16) source.fail("is in UTF-16, which is not read; save it in UTF-8");
  }
  const std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(nullptr),
                                                                       XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  return VtpListener(source, parser.get()).read();
}

}  // namespace keepout
