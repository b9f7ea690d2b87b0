#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "echofuse/link/codec.hpp"
#include "link/vectors.hpp"

namespace echofuse::link {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::read_vectors;
using testing::span_of;
using testing::Vector;

Vector vector_of(const char* name) {
  const auto vectors = read_vectors();
  REQUIRE(vectors.count(name) == 1);
  return vectors.at(name);
}

/// What an encoder writes, and nothing behind it.
template <class Encoder>
Bytes encoded(Encoder&& encoder) {
  Bytes out(kMaxPayloadBytes + 1, 0xA5);
  const std::size_t size = encoder(Span<std::uint8_t>{out.data(), out.size() - 1});
  CHECK(std::all_of(out.begin() + static_cast<std::ptrdiff_t>(size), out.end(),
                    [](std::uint8_t byte) { return byte == 0xA5; }));
  out.resize(size);
  return out;
}

template <class Message>
Bytes payload_of(const Message& message) {
  return encoded([&](Span<std::uint8_t> out) { return encode(message, out); });
}

/// The report of the vector `four_detections`.
struct FourDetections : Detections {
  FourDetections() {
    node_id = 65534;
    frame = 0xFFFFFFFFU;
    time_us = -2;
    for (int k = 1; k <= 4; ++k)
      REQUIRE(detections.try_push_back({static_cast<float>(k * 3.5e-9), static_cast<float>(100 * k + 7)}));
  }
};

}  // namespace

TEST_CASE("Detections are PyCyphal's bytes, in at most 64 of them on the wire, and come back as they were") {
  const Vector vector = vector_of("four_detections");
  CHECK(payload_of(FourDetections{}) == vector.payload);
  CHECK(vector.frame.size() <= 64);
  const TransferHeader header = header_of(FourDetections{}, 6200);
  CHECK(header.source == vector.source);
  CHECK(header.transfer_id == vector.transfer_id);
  Detections report;
  REQUIRE(decode(header, span_of(vector.payload), report) == Status::kOk);
  CHECK(report.node_id == 65534);
  CHECK(report.frame == 0xFFFFFFFFU);
  CHECK(report.time_us == -2);
  REQUIRE(report.detections.size() == 4);
  const FourDetections sent;
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(report.detections[i].delay_s == sent.detections[i].delay_s);
    CHECK(report.detections[i].weight == sent.detections[i].weight);
  }
}

TEST_CASE("weights beyond 16 bits are held at the end of their range") {
  Detections report;
  for (const float weight : {-3.0f, 65535.0f, 1e9f})
    REQUIRE(report.detections.try_push_back({1e-9f, weight}));
  const Bytes payload = payload_of(report);
  REQUIRE(decode({}, span_of(payload), report) == Status::kOk);
  CHECK(report.detections[0].weight == 0.0f);
  CHECK(report.detections[1].weight == 65535.0f);
  CHECK(report.detections[2].weight == 65535.0f);
}

TEST_CASE("a report of more detections than there can be is refused, and leaves none") {
  FourDetections report;
  for (const std::uint8_t count : {std::uint8_t{17}, std::uint8_t{255}}) {
    Bytes payload(8 + 6 * 255);
    payload[7] = count;
    CHECK(decode({}, span_of(payload), report) == Status::kInvalidInput);
    CHECK(report.detections.empty());
  }
}

TEST_CASE("our messages are refused when they are cut short") {
  for (const char* name : {"four_detections", "no_detections", "track", "spatial_track", "health"}) {
    const Vector vector = vector_of(name);
    Detections report;
    Tracks tracks;
    NodeHealth health;
    for (std::size_t size = 0; size < vector.payload.size(); ++size) {
      const Span<const std::uint8_t> cut{vector.payload.data(), size};
      const Status status = vector.subject == 6200   ? decode({}, cut, report)
                            : vector.subject == 6201 ? decode(cut, tracks)
                            : vector.subject == 6208 ? decode_spatial(cut, tracks)
                                                     : decode(cut, health);
      REQUIRE(status == Status::kInvalidInput);
    }
  }
}

TEST_CASE("Tracks are PyCyphal's bytes; a state that does not exist is refused") {
  const Vector vector = vector_of("track");
  Tracks tracks;
  REQUIRE(decode(span_of(vector.payload), tracks) == Status::kOk);
  CHECK(tracks.time_us == 1234567);
  CHECK(tracks.frame == 12);
  REQUIRE(tracks.tracks.size() == 1);
  const Track& track = tracks.tracks[0];
  CHECK(track.id == 9);
  CHECK(track.state == TrackState::kSilent);
  CHECK(track.frames_since_update == 3);
  CHECK(track.y_m == -2.25f);
  CHECK(track.vy_mps == 1e-3f);
  CHECK(track.covariance_yy_m2 == 0.09f);
  CHECK(track.z_m == 0.0f);
  CHECK(track.covariance_zz_m2 == 0.0f);
  CHECK(payload_of(tracks) == vector.payload);
  Bytes wrong = vector.payload;
  wrong[12 + 4] = 4;
  CHECK(decode(span_of(wrong), tracks) == Status::kInvalidInput);
  CHECK(tracks.tracks.empty());
}

TEST_CASE("SpatialTracks are PyCyphal's bytes; a state that does not exist is refused") {
  const Vector vector = vector_of("spatial_track");
  Tracks tracks;
  REQUIRE(decode_spatial(span_of(vector.payload), tracks) == Status::kOk);
  CHECK(tracks.time_us == 1234567);
  CHECK(tracks.frame == 12);
  REQUIRE(tracks.tracks.size() == 1);
  const Track& track = tracks.tracks[0];
  CHECK(track.id == 9);
  CHECK(track.y_m == -2.25f);
  CHECK(track.z_m == 1.125f);
  CHECK(track.vy_mps == 1e-3f);
  CHECK(track.vz_mps == -0.5f);
  CHECK(track.covariance_yy_m2 == 0.09f);
  CHECK(track.covariance_xz_m2 == 0.02f);
  CHECK(track.covariance_yz_m2 == -0.03f);
  CHECK(track.covariance_zz_m2 == 0.16f);
  CHECK(encoded([&](Span<std::uint8_t> out) { return encode_spatial(tracks, out); }) == vector.payload);
  Bytes wrong = vector.payload;
  wrong[12 + 4] = 4;
  CHECK(decode_spatial(span_of(wrong), tracks) == Status::kInvalidInput);
  CHECK(tracks.tracks.empty());
}

TEST_CASE("the most tracks that there can be fit into a payload, in the plane and in space") {
  Tracks tracks;
  while (tracks.tracks.size() < kMaxTracks)
    REQUIRE(tracks.tracks.try_push_back(
        {1, TrackState::kConfirmed, 100000, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
  const Bytes payload = payload_of(tracks);
  CHECK(payload.size() == 12 + 35 * kMaxTracks);
  const Bytes in_space = encoded([&](Span<std::uint8_t> out) { return encode_spatial(tracks, out); });
  CHECK(in_space.size() == 12 + 55 * kMaxTracks);
  REQUIRE(decode(span_of(payload), tracks) == Status::kOk);
  CHECK(tracks.tracks.size() == kMaxTracks);
  CHECK(tracks.tracks[0].frames_since_update == 65535);
  CHECK(tracks.tracks[0].covariance_zz_m2 == 0.0f);
  REQUIRE(decode_spatial(span_of(in_space), tracks) == Status::kOk);
  CHECK(tracks.tracks.size() == kMaxTracks);
  CHECK(tracks.tracks[0].covariance_zz_m2 == 12.0f);
}

TEST_CASE("NodeHealth is PyCyphal's bytes; a kind that does not exist is refused") {
  const Vector vector = vector_of("health");
  NodeHealth health;
  REQUIRE(decode(span_of(vector.payload), health) == Status::kOk);
  CHECK(health.kind == MachineKind::kSensorRadarHub);
  REQUIRE(health.values.size() == vector.payload[1]);
  for (std::size_t i = 0; i < health.values.size(); ++i) CHECK(health.values[i] == 255 * i);
  CHECK(payload_of(health) == vector.payload);
  Bytes wrong = vector.payload;
  wrong[0] = 5;
  CHECK(decode(span_of(wrong), health) == Status::kInvalidInput);
  CHECK(health.values.empty());
}

TEST_CASE("Heartbeat is PyCyphal's bytes; a mode that does not exist is refused") {
  const Vector vector = vector_of("heartbeat");
  Heartbeat beat;
  REQUIRE(decode(span_of(vector.payload), beat) == Status::kOk);
  CHECK(beat.uptime_s == 86400);
  CHECK(beat.health == Health::kCaution);
  CHECK(beat.mode == Mode::kInitialization);
  CHECK(beat.vendor_status == 255);
  CHECK(payload_of(beat) == vector.payload);
  Bytes wrong = vector.payload;
  wrong[5] = 4;
  CHECK(decode(span_of(wrong), beat) == Status::kInvalidInput);
}

TEST_CASE("Synchronization is PyCyphal's bytes") {
  const Vector vector = vector_of("synchronization");
  std::uint64_t previous_us = 0;
  REQUIRE(decode_synchronization(span_of(vector.payload), previous_us) == Status::kOk);
  CHECK(previous_us == 5000000);
  CHECK(encoded([](Span<std::uint8_t> out) { return encode_synchronization(5000000, out); }) ==
        vector.payload);
}

TEST_CASE("a raw scan comes back; what its reader has no room for is left out and told") {
  const std::array<float, 3> samples{1.5f, -2.0f, std::numeric_limits<float>::max()};
  const Bytes payload = encoded([&](Span<std::uint8_t> out) { return encode_raw_scan(-1, samples, out); });
  CHECK(payload.size() == 9 + 12);
  std::array<float, 4> read{};
  std::int64_t time_us = 0;
  std::size_t n_samples = 0;
  REQUIRE(decode_raw_scan(span_of(payload), time_us, read, n_samples) == Status::kOk);
  CHECK(time_us == -1);
  CHECK(n_samples == 3);
  CHECK(std::equal(samples.begin(), samples.end(), read.begin()));
  read = {};
  REQUIRE(decode_raw_scan(span_of(payload), time_us, {read.data(), 1}, n_samples) == Status::kOk);
  CHECK(n_samples == 3);
  CHECK(read == std::array<float, 4>{1.5f, 0, 0, 0});
  CHECK(decode_raw_scan({payload.data(), payload.size() - 1}, time_us, read, n_samples) ==
        Status::kInvalidInput);
  CHECK(n_samples == 0);
}

TEST_CASE("where a message has no room, nothing is encoded") {
  std::array<std::uint8_t, 31> little{};
  CHECK(encode(FourDetections{}, little) == 0);
  CHECK(encode_raw_scan(0, std::array<float, 8>{}, little) == 0);
}

}  // namespace echofuse::link
