// SPDX-License-Identifier: BSD-3-Clause
// The codec alone: pieces of any size, declared sizes, and bodies of hostile peers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "apps/igtl/client_messages.h"
#include "igtl/polydata.h"
#include "igtl/stream.h"
#include "keepout/error.h"
#include "meshes.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::igtl {
namespace {

using Event = MessageStream::Event;

Bytes content(const ByteList& message) { return Bytes(message).subspan(header_size); }

// The check value of CRC-64/ECMA-182 in the catalogue of CRC algorithms.
TEST(IgtlCodec, TheCrcIsThatOfEcma182) {
  const std::string_view digits = "123456789";
  const ByteList bytes(digits.begin(), digits.end());
  EXPECT_EQ(crc64(bytes), 0x6C40DF5F0B497347u);
  EXPECT_EQ(crc64(Bytes(bytes).subspan(4), crc64(Bytes(bytes).first(4))), crc64(bytes));
}

TEST(IgtlCodec, AMessageThatComesInPiecesIsTheSame) {
  const ByteList sent = joined(transform(Pose{{1, -2, 3e-3}, turned(0.3)}, "Tool", 1.5),
                               joined(string_message("engage"), message("GET_STATUS", "", {})));
  std::mt19937_64 random(1);
  for (int trial = 0; trial < trials(400); ++trial) {
    MessageStream stream(1000);
    std::vector<std::string> taken;
    for (Bytes rest = sent; !rest.empty();) {
      Bytes piece = rest.first(std::min<std::size_t>(1 + random() % 90, rest.size()));
      rest = rest.subspan(piece.size());
      for (Event event = stream.next(piece); event != Event::needs_more;
           event = stream.next(piece)) {
        if (event == Event::header) stream.store_body();
        if (event != Event::message) continue;
        EXPECT_TRUE(stream.is_intact());
        taken.emplace_back(stream.header().type_name());
        if (taken.size() > 1) continue;
        EXPECT_EQ(stream.header().device_name(), "Tool");
        EXPECT_EQ(stream.header().stamp, 1.5);
        EXPECT_EQ(read_transform(stream.body())->rotation,
                  turned(0.3).cast<float>().cast<double>());
      }
    }
    EXPECT_EQ(taken, (std::vector<std::string>{"TRANSFORM", "STRING", "GET_STATUS"}));
  }
}

// A declared size allocates nothing before it was compared with the limit, and a body that is not
// taken is never stored.
TEST(IgtlCodec, ADeclaredSizeAboveTheLimitEndsTheStream) {
  for (const std::uint64_t size :
       {std::uint64_t{1001}, std::uint64_t{1} << 62, ~std::uint64_t{0}}) {
    MessageStream stream(1000);
    const ByteList sent = changed(transform(Vec3::Zero()), 42, 8, size);
    Bytes rest = sent;
    EXPECT_EQ(stream.next(rest), Event::broken);
    EXPECT_EQ(stream.next(rest), Event::broken);
    EXPECT_FALSE(stream.is_stored());
  }
  for (const std::uint64_t version : {0, 3, 0x5353}) {
    MessageStream stream(1000);
    const ByteList sent = changed(transform(Vec3::Zero()), 0, 2, version);
    Bytes rest = sent;
    EXPECT_EQ(stream.next(rest), Event::broken) << version;
  }
}

TEST(IgtlCodec, EveryChangedBitOfABodyIsFoundByTheCrc) {
  const ByteList sent = transform(Pose{{1, -2, 3e-3}, turned(0.3)});
  for (std::size_t bit = 8 * header_size; bit < 8 * sent.size(); ++bit) {
    ByteList damaged = sent;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    MessageStream stream(1000);
    Bytes rest = damaged;
    EXPECT_EQ(stream.next(rest), Event::header);
    stream.store_body();
    EXPECT_EQ(stream.next(rest), Event::message);
    EXPECT_FALSE(stream.is_intact());
  }
}

// Header version 2 (protocol version 3): extended header, content, metadata.
TEST(IgtlCodec, ExtendedHeaderAndMetadataAreLeftOut) {
  ByteList out;
  Writer writer(out, "STRING", "", 0.0);
  writer.number(std::uint16_t{12});
  writer.number(std::uint16_t{2});
  writer.number(std::uint32_t{3});
  writer.number(std::uint32_t{77});
  writer.text("contentmmmmm");
  writer.finish();
  const Header two{.version = 2};
  const Bytes body = content(out);
  const auto inner = content_of(two, body);
  ASSERT_TRUE(inner);
  EXPECT_EQ(std::string(inner->begin(), inner->end()), "content");
  for (const auto& [at, size, value] :
       {std::tuple{0, 2, 11u}, {0, 2, 0xFFFFu}, {2, 2, 0xFFFFu}, {4, 4, 0xFFFFFFFFu}}) {
    const ByteList wrong = changed({body.begin(), body.end()}, at, size, value);
    EXPECT_FALSE(content_of(two, wrong)) << at << ' ' << value;
  }
  EXPECT_FALSE(content_of(two, body.first(11)));
}

TEST(IgtlCodec, SmallBodiesOfAnotherSizeAreRefused) {
  const ByteList pose = transform(Vec3::Zero());
  EXPECT_FALSE(read_transform(content(pose).first(47)));
  const ByteList text = string_message("engage");
  EXPECT_EQ(read_string(content(text)), "engage");
  EXPECT_FALSE(read_string(content(text).first(3)));
  EXPECT_FALSE(read_string(content(text).first(9)));
  const std::vector<Vec3> three{{1, 2, 3}, {4, 5, 6}, {-7, 8, 9}};
  const ByteList points = point_message("Model", three);
  EXPECT_EQ(read_points(content(points)), three);
  EXPECT_FALSE(read_points(content(points).first(135)));
  EXPECT_FALSE(read_points(ByteList(point_size * (most_points + 1))));
}

TEST(IgtlCodec, TrianglesAndStripsOfPolydataAreThoseThatWereSent) {
  const Surface sent = as_floats(torus(8));
  for (const bool has_strips : {false, true}) {
    const Surface read = read_polydata(content(polydata(sent, has_strips)));
    EXPECT_EQ(read.vertices, sent.vertices);
    auto expected = sent.triangles;
    auto triangles = read.triangles;
    std::ranges::sort(expected);
    std::ranges::sort(triangles);
    EXPECT_EQ(triangles, expected);
  }
  // Every second triangle of a long strip is turned back to one winding.
  ByteList strip;
  Writer writer(strip, "POLYDATA", "", 0.0);
  for (const std::uint32_t n : {4u, 0u, 0u, 0u, 0u, 0u, 0u, 1u, 20u, 0u}) writer.number(n);
  for (int i = 0; i < 12; ++i) writer.real(i);
  for (const std::uint32_t n : {4u, 0u, 1u, 2u, 3u}) writer.number(n);
  writer.finish();
  EXPECT_EQ(read_polydata(content(strip)).triangles, (std::vector<Corners>{{0, 1, 2}, {2, 1, 3}}));
}

TEST(IgtlCodec, WrongPolydataIsRefusedWithItsFault) {
  const ByteList sent = polydata(tetrahedron());
  const auto fault = [&](std::size_t at, std::uint32_t value) {
    const ByteList wrong = changed(sent, header_size + at, 4, value);
    return error_of([&] { read_polydata(content(wrong)); });
  };
  EXPECT_CONTAINS(fault(0, 5), "contradict the size");
  EXPECT_CONTAINS(fault(0, 0x55555556), "contradict the size") << "12 times this is 8 in 32 bits";
  EXPECT_CONTAINS(fault(0, 3), "contradict the size");
  EXPECT_CONTAINS(fault(24, 0xFFFFFFF0), "contradict the size");
  EXPECT_CONTAINS(fault(20, 3), "not a triangle");
  EXPECT_CONTAINS(fault(40 + 48, 4), "not a triangle");
  EXPECT_CONTAINS(fault(40 + 48 + 4, 4), "names point 4, but there are only 4");
  EXPECT_CONTAINS(error_of([] { read_polydata({}); }), "too short");
  const ByteList nothing = polydata(Surface{});
  EXPECT_CONTAINS(error_of([&] { read_polydata(content(nothing)); }), "no triangle");
}

/// Changes a few numbers or bytes of a body.
void garble(ByteList& body, std::mt19937_64& random) {
  for (std::uint64_t changes = 1 + random() % 4; changes > 0 && !body.empty(); --changes) {
    const std::size_t at = random() % body.size();
    switch (random() % 6) {
      case 0:
        body[at] = static_cast<std::uint8_t>(random());
        break;
      case 1:
        body.resize(at);
        break;
      case 2:
        body.insert(body.end(), random() % 40, static_cast<std::uint8_t>(random()));
        break;
      default: {  // a number, most often one of the sizes at the beginning
        constexpr std::uint32_t hostile[] = {0,          1,          2,          4,
                                             0x3FFFFFFF, 0x7FFFFFFF, 0x80000000, 0x10000000,
                                             0xFFFFFFFF, 0xFFFFFFFE, 0x55555556, 0x15555556};
        const std::size_t word = random() % 2 == 0 ? random() % 10 : at / 4;
        if (4 * word + 4 > body.size()) break;
        const std::uint32_t value = random() % 3 == 0 ? static_cast<std::uint32_t>(random())
                                                      : hostile[random() % std::size(hostile)];
        body = changed(std::move(body), 4 * word, 4, value);
      }
    }
  }
}

// The memory of each body is a block of its own, so that the sanitizers find a read behind it.
TEST(IgtlCodec, HostilePolydataIsRefusedOrReadWithinItsBounds) {
  std::mt19937_64 random(2026);
  const int all = all_trials() ? 1'000'000 : 10'000;
  int read = 0;
  for (int trial = 0; trial < all; ++trial) {
    const ByteList whole =
        trial % 2 == 0 ? polydata(tetrahedron(), true) : polydata(single_triangle());
    ByteList body(whole.begin() + header_size, whole.end());
    garble(body, random);
    const auto exact = std::make_unique<std::uint8_t[]>(body.size());
    std::ranges::copy(body, exact.get());
    try {
      const Surface surface = read_polydata({exact.get(), body.size()});
      ++read;
      for (const Corners& corners : surface.triangles) {
        for (const VertexId corner : corners) ASSERT_LT(corner, surface.vertices.size());
      }
      ASSERT_LE(surface.triangles.size(), body.size() / 4);
      ASSERT_LE(surface.vertices.size(), body.size() / 12);
    } catch (const Error& error) {
      ASSERT_TRUE(std::string_view(error.what()).starts_with("POLYDATA: ")) << error.what();
    }
  }
  EXPECT_GT(read, all / 20) << "the test is meaningful only with bodies of both kinds";
  EXPECT_LT(read, all / 2);
}

// Streams of garbled messages: each event uses bytes or ends, and no body is longer than declared.
TEST(IgtlCodec, AHostileStreamIsCutWithinItsBounds) {
  std::mt19937_64 random(7);
  const int all = all_trials() ? 1'000'000 : 10'000;
  for (int messages = 0; messages < all;) {
    ByteList sent;
    for (int i = 0; i < 20; ++i, ++messages) {
      ByteList one = random() % 2 == 0 ? transform(Vec3(1, 2, 3)) : string_message("engage");
      if (random() % 4 == 0) garble(one, random);
      sent = joined(std::move(sent), one);
    }
    MessageStream stream(500);
    for (Bytes rest = sent; !rest.empty();) {
      Bytes piece = rest.first(std::min<std::size_t>(1 + random() % 200, rest.size()));
      rest = rest.subspan(piece.size());
      for (Event event = stream.next(piece); event != Event::needs_more;
           event = stream.next(piece)) {
        if (event == Event::broken) break;
        if (event == Event::header && random() % 2 == 0) stream.store_body();
        if (event != Event::message || !stream.is_stored()) continue;
        ASSERT_EQ(stream.body().size(), stream.header().body_size);
        const auto inner = content_of(stream.header(), stream.body());
        if (!inner) continue;
        read_transform(*inner);
        read_string(*inner);
        read_points(*inner);
      }
    }
  }
}

}  // namespace
}  // namespace keepout::test::igtl
