// SPDX-License-Identifier: BSD-3-Clause
#include "apps/igtl/library_peer.h"

#include <igtlClientSocket.h>
#include <igtlMessageHeader.h>
#include <igtlPointMessage.h>
#include <igtlPolyDataMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTimeStamp.h>
#include <igtlTransformMessage.h>

#include <stdexcept>
#include <utility>

namespace keepout::test::igtl {
namespace {

namespace library = ::igtl;

constexpr int patience = 20'000;  // for a message, on a busy machine [ms]

template <class Message>
void send(library::ClientSocket& socket, Message& message, bool has_stamp = false) {
  if (!has_stamp) message.SetTimeStamp(0U, 0U);  // the library leaves it uninitialized
  message.Pack();
  if (socket.Send(message.GetPackPointer(), message.GetPackSize()) == 0) {
    throw std::runtime_error("the library could not send");
  }
}

library::TransformMessage::Pointer transform_message(const std::string& device,
                                                     const LibraryPeer::Matrix& matrix) {
  library::Matrix4x4 rows;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) rows[i][j] = matrix[i][j];
  }
  auto message = library::TransformMessage::New();
  message->SetDeviceName(device.c_str());
  message->SetMatrix(rows);
  return message;
}

/// Reads the body of a message, and lets the library check its CRC.
template <class Message>
typename Message::Pointer body_of(library::ClientSocket& socket,
                                  const library::MessageHeader& header) {
  auto message = Message::New();
  message->SetMessageHeader(&header);
  message->AllocatePack();
  if (message->GetPackBodySize() > 0 &&
      socket.Receive(message->GetPackBodyPointer(), message->GetPackBodySize()) !=
          message->GetPackBodySize()) {
    throw std::runtime_error("half a message came");
  }
  if ((message->Unpack(1) & library::MessageHeader::UNPACK_BODY) == 0) {
    throw std::runtime_error("the library refused a body");
  }
  return message;
}

}  // namespace

struct LibraryPeer::Socket {
  library::ClientSocket::Pointer socket = library::ClientSocket::New();
};

LibraryPeer::LibraryPeer(std::uint16_t port) : socket_(std::make_unique<Socket>()) {
  if (socket_->socket->ConnectToServer("127.0.0.1", port) != 0) {
    throw std::runtime_error("the library could not connect");
  }
}

LibraryPeer::~LibraryPeer() {
  if (socket_ != nullptr) socket_->socket->CloseSocket();
}

LibraryPeer::LibraryPeer(LibraryPeer&&) noexcept = default;
LibraryPeer& LibraryPeer::operator=(LibraryPeer&&) noexcept = default;

void LibraryPeer::send_transform(const std::string& device, const Matrix& matrix, Stamp stamp) {
  const auto message = transform_message(device, matrix);
  if (stamp == Stamp::now) {
    auto time = library::TimeStamp::New();
    time->GetTime();
    message->SetTimeStamp(time);
  }
  send(*socket_->socket, *message, stamp == Stamp::now);
}

void LibraryPeer::send_string(const std::string& text) {
  auto message = library::StringMessage::New();
  message->SetDeviceName("Command");
  message->SetString(text.c_str());
  send(*socket_->socket, *message);
}

void LibraryPeer::send_points(const std::string& device, const std::vector<Point>& points) {
  auto message = library::PointMessage::New();
  message->SetDeviceName(device.c_str());
  for (const Point& point : points) {
    auto element = library::PointElement::New();
    element->SetName("fiducial");
    element->SetGroupName("Fiducial");
    element->SetRGBA(255, 0, 0, 255);
    element->SetPosition(point[0], point[1], point[2]);
    element->SetRadius(1.0F);
    element->SetOwner("CT");
    message->AddPointElement(element);
  }
  send(*socket_->socket, *message);
}

void LibraryPeer::send_polydata(const std::vector<Point>& points,
                                const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  auto array = library::PolyDataPointArray::New();
  for (const Point& p : points) array->AddPoint(p[0], p[1], p[2]);
  auto cells = library::PolyDataCellArray::New();
  for (std::array<std::uint32_t, 3> triangle : triangles) cells->AddCell(3, triangle.data());
  // The library packs these parts only if they exist.
  auto message = library::PolyDataMessage::New();
  message->SetDeviceName("Model");
  message->SetPoints(array);
  message->SetPolygons(cells);
  auto scalars = library::PolyDataAttribute::New();
  scalars->SetType(library::PolyDataAttribute::POINT_SCALAR, 1);
  scalars->SetName("curvature");
  scalars->SetSize(static_cast<std::uint32_t>(points.size()));
  std::vector<float> values(points.size(), 0.5F);
  scalars->SetData(values.data());
  message->AddAttribute(scalars);
  send(*socket_->socket, *message);
}

LibraryPeer::Message LibraryPeer::receive() {
  library::ClientSocket& socket = *socket_->socket;
  auto header = library::MessageHeader::New();
  header->InitPack();
  socket.SetReceiveTimeout(patience);
  const int count = socket.Receive(header->GetPackPointer(), header->GetPackSize());
  if (count != header->GetPackSize()) throw std::runtime_error("no message came");
  header->Unpack();
  Message message;
  message.type = header->GetDeviceType();
  message.device = header->GetDeviceName();
  if (message.type == "TRANSFORM") {
    library::Matrix4x4 rows;
    body_of<library::TransformMessage>(socket, *header)->GetMatrix(rows);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) message.matrix[i][j] = rows[i][j];
    }
  } else if (message.type == "STATUS") {
    const auto status = body_of<library::StatusMessage>(socket, *header);
    message.code = status->GetCode();
    message.name = status->GetErrorName();
    message.text = status->GetStatusString();
  } else if (message.type == "POLYDATA") {
    const auto polydata = body_of<library::PolyDataMessage>(socket, *header);
    const auto points = polydata->GetPoints();
    for (int i = 0; i < points->GetNumberOfPoints(); ++i) {
      points->GetPoint(i, message.points.emplace_back().data());
    }
    const auto cells = polydata->GetPolygons();
    for (unsigned i = 0; i < cells->GetNumberOfCells(); ++i) {
      cells->GetCell(i, message.triangles.emplace_back().data());
    }
  } else {
    throw std::runtime_error("a message of another type came: " + message.type);
  }
  return message;
}

LibraryPeer::Message LibraryPeer::receive(const std::string& device) {
  while (true) {
    Message message = receive();
    if (message.device == device) return message;
  }
}

std::vector<std::uint8_t> LibraryPeer::packed_transform(const std::string& device,
                                                        const Matrix& matrix) {
  const auto message = transform_message(device, matrix);
  message->SetTimeStamp(1U, 0x80000000U);
  message->Pack();
  const auto* const bytes = static_cast<const std::uint8_t*>(message->GetPackPointer());
  return {bytes, bytes + message->GetPackSize()};
}

}  // namespace keepout::test::igtl
