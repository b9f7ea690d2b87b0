#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common.hpp"
#include "echofuse/hub/registers.hpp"
#include "echofuse/link/codec.hpp"
#include "echofuse/link/crc.hpp"
#include "echofuse/link/endpoint.hpp"
#include "echofuse/link/frame.hpp"
#include "echofuse/node/node.hpp"
#include "echofuse/node/registers.hpp"
#include "hub.hpp"
#include "tracks.hpp"

namespace echofuse::bindings {
namespace {

using link::FrameReader;
using link::TransferHeader;
using link::TransferKind;

Span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

py::bytes to_bytes(Span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A payload as an encoder makes it, in the firmware's own room.
template <class Encoder>
py::bytes encoded(Encoder&& encoder) {
  std::array<std::uint8_t, kMaxPayloadBytes> payload;
  const std::size_t size = encoder(Span<std::uint8_t>(payload));
  if (size == 0) throw py::value_error("no room for this message");
  return to_bytes({payload.data(), size});
}

py::bytes write_frame(std::uint16_t source, std::uint16_t port, std::uint64_t transfer_id,
                      const std::string& payload, TransferKind kind, std::uint16_t destination,
                      std::uint8_t priority) {
  std::vector<std::uint8_t> frame(link::frame_bytes(payload.size()));
  const TransferHeader header{priority, source, destination, kind, port, transfer_id};
  const std::size_t size = link::write_frame(header, bytes_of(payload), {frame.data(), frame.size()});
  return to_bytes({frame.data(), size});
}

/// A FrameReader with its buffer.
class Reader {
 public:
  explicit Reader(std::size_t capacity) : buffer_(capacity), reader_({buffer_.data(), buffer_.size()}) {}

  py::list feed(const std::string& bytes, std::int64_t now_us) {
    py::list transfers;
    for (const std::uint8_t byte : bytes_of(bytes)) {
      if (!reader_.push(byte, now_us)) continue;
      const TransferHeader& h = reader_.header();
      transfers.append(py::make_tuple(h.source, h.port_id, h.transfer_id, to_bytes(reader_.payload()), h.kind,
                                      h.destination, h.priority));
    }
    return transfers;
  }

  py::dict counters() const {
    const link::FrameCounters& c = reader_.counters();
    py::dict by_name;
    by_name["frames"] = c.frames;
    by_name["bad_cobs"] = c.bad_cobs;
    by_name["bad_length"] = c.bad_length;
    by_name["bad_version"] = c.bad_version;
    by_name["bad_header_crc"] = c.bad_header_crc;
    by_name["bad_payload_crc"] = c.bad_payload_crc;
    by_name["multi_frame"] = c.multi_frame;
    by_name["repeated"] = c.repeated;
    return by_name;
  }

 private:
  std::vector<std::uint8_t> buffer_;
  FrameReader reader_;
};

/// An endpoint whose bytes are kept for Python: what a machine does with the link apart from its pipeline.
class LinkMachine {
 public:
  explicit LinkMachine(std::uint16_t node_id)
      : buffer_(link::kFrameHeaderBytes + link::kFrameCrcBytes + kMaxPayloadBytes),
        endpoint_({buffer_.data(), buffer_.size()}, &keep, "echofuse.test") {
    endpoint_.start(node_id, 0);
    if (!endpoint_.registers().add({node::config_registers(), &config_})) throw py::value_error("no room");
  }

  py::bytes feed(const std::string& bytes, std::int64_t now_us) {
    sent.clear();
    for (const std::uint8_t byte : bytes_of(bytes)) (void)endpoint_.push(byte, now_us);
    return sent;
  }
  py::bytes heartbeat(std::int64_t now_us) {
    sent.clear();
    (void)endpoint_.heartbeat(now_us, link::Health::kNominal, link::Mode::kOperational);
    return sent;
  }
  std::uint32_t refused_writes() const { return endpoint_.registers().refused_writes(); }

 private:
  static void keep(Span<const std::uint8_t> bytes) {
    sent.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  static inline std::string sent;

  std::vector<std::uint8_t> buffer_;
  node::SensorRadarNodeConfig config_;
  link::Endpoint endpoint_;
};

std::vector<std::string> register_names(Span<const link::RegisterField> fields) {
  std::vector<std::string> names;
  for (const link::RegisterField& field : fields) names.emplace_back(field.name);
  return names;
}

void bind_frames(py::module_& m) {
  py::enum_<TransferKind>(m, "TransferKind")
      .value("message", TransferKind::kMessage)
      .value("request", TransferKind::kRequest)
      .value("response", TransferKind::kResponse);
  m.def(
      "crc16", [](const std::string& data) { return link::crc16(bytes_of(data)); }, py::arg("data"));
  m.def(
      "crc32c", [](const std::string& data) { return link::crc32c(bytes_of(data)); }, py::arg("data"));
  m.def("write_frame", &write_frame, py::arg("source"), py::arg("port"), py::arg("transfer_id"),
        py::arg("payload"), py::kw_only(), py::arg("kind") = TransferKind::kMessage,
        py::arg("destination") = link::kBroadcast, py::arg("priority") = 4, "One frame with its delimiters.");
  py::class_<Reader>(m, "LinkReader", "Finds frames in a byte stream.")
      .def(py::init<std::size_t>(), py::arg("capacity"),
           "capacity: [byte] of header, payload and CRC of the longest frame.")
      .def("feed", &Reader::feed, py::arg("data"), py::arg("now_us"),
           "[(source, port, transfer_id, payload, kind, destination, priority)] of the transfers completed.")
      .def("counters", &Reader::counters);
  py::class_<LinkMachine>(m, "LinkMachine", "A machine on the link without a pipeline; a node's registers.")
      .def(py::init<std::uint16_t>(), py::arg("node_id"))
      .def("feed", &LinkMachine::feed, py::arg("data"), py::arg("now_us"), "What it answers.")
      .def("heartbeat", &LinkMachine::heartbeat, py::arg("now_us"))
      .def("refused_writes", &LinkMachine::refused_writes);
}

void bind_detections(py::module_& m) {
  using link::Detection;
  PYBIND11_NUMPY_DTYPE(Detection, delay_s, weight);
  m.def(
      "encode_detections",
      [](std::int64_t time_us, const FloatArray& delay_s, const FloatArray& weight) {
        link::Detections report;
        report.time_us = time_us;
        fill_detections(report, delay_s, weight);
        return encoded([&](Span<std::uint8_t> out) { return link::encode(report, out); });
      },
      py::arg("time_us"), py::arg("delay_s").noconvert(), py::arg("weight").noconvert());
  m.def(
      "decode_detections",
      [](std::uint16_t source, std::uint64_t transfer_id, const std::string& payload) {
        link::Detections report;
        TransferHeader header;
        header.source = source;
        header.transfer_id = transfer_id;
        const Status status = link::decode(header, bytes_of(payload), report);
        return py::make_tuple(status, report.node_id, report.frame, report.time_us,
                              to_array(report.detections));
      },
      py::arg("source"), py::arg("transfer_id"), py::arg("payload"),
      "(status, node_id, frame, time_us, detections)");
}

using TracksEncoder = std::size_t (*)(const link::Tracks&, Span<std::uint8_t>);
using TracksDecoder = Status (*)(Span<const std::uint8_t>, link::Tracks&);

/// `encode_NAME` and `decode_NAME` of one of the messages that carry tracks.
void bind_tracks(py::module_& m, const std::string& name, TracksEncoder encode, TracksDecoder decode) {
  m.def(("encode_" + name).c_str(),
        [encode](std::int64_t time_us, std::uint32_t frame, const ArrayOf<link::Track>& rows) {
          link::Tracks tracks;
          tracks.time_us = time_us;
          tracks.frame = frame;
          for (const link::Track& track : as_span(rows, "tracks"))
            if (!tracks.tracks.try_push_back(track)) throw py::value_error("too many tracks");
          return encoded([&](Span<std::uint8_t> out) { return encode(tracks, out); });
        },
        py::arg("time_us"), py::arg("frame"), py::arg("tracks").noconvert());
  m.def(("decode_" + name).c_str(),
        [decode](const std::string& payload) {
          link::Tracks tracks;
          const Status status = decode(bytes_of(payload), tracks);
          return py::make_tuple(status, tracks.time_us, tracks.frame, to_array(tracks));
        },
        py::arg("payload"), "(status, time_us, frame, tracks)");
}

}  // namespace

void bind_link(py::module_& m) {
  bind_frames(m);
  bind_detections(m);
  bind_tracks(m, "tracks", &link::encode, &link::decode);
  bind_tracks(m, "spatial_tracks", &link::encode_spatial, &link::decode_spatial);
  m.def(
      "node_registers", [] { return register_names(node::config_registers()); },
      "Names of a node's configuration on the link.");
  m.def(
      "through_wall_node_registers", [] { return register_names(node::through_wall_registers()); },
      "Names of a through-wall node's configuration on the link.");
  m.def(
      "hub_registers", [] { return register_names(hub::config_registers()); },
      "Names of a hub's configuration on the link; '#' stands for the index of a node.");
  m.def(
      "through_wall_hub_registers", [] { return register_names(hub::through_wall_registers()); },
      "Names of a hub's configuration on the link; '#' stands for the index of a node.");
  m.def(
      "through_wall_3d_hub_registers", [] { return register_names(hub::through_wall_3d_registers()); },
      "Names of a hub's configuration on the link; '#' stands for the index of a node.");
}

}  // namespace echofuse::bindings
