// SPDX-License-Identifier: Apache-2.0
#include "truth.h"

namespace tactus::c {
namespace {

static_assert(TACTUS_CONTACT_NONE == static_cast<int>(ContactKind::none) &&
              TACTUS_CONTACT_SURFACE == static_cast<int>(ContactKind::surface) &&
              TACTUS_CONTACT_SPRING == static_cast<int>(ContactKind::spring));

static_assert(TACTUS_PART_OBJECT == static_cast<int>(TruthPart::object) &&
              TACTUS_PART_CONTACT == static_cast<int>(TruthPart::contact) &&
              TACTUS_PART_SHAPE == static_cast<int>(TruthPart::shape) &&
              TACTUS_PART_TOUCH == static_cast<int>(TruthPart::touch) && TACTUS_PART_LOAD == static_cast<int>(TruthPart::load));

/// One that there is none of breaks R-API-15.
ContactKind kind_of(std::int32_t kind) noexcept {
  return static_cast<ContactKind>(kind >= TACTUS_CONTACT_NONE && kind <= TACTUS_CONTACT_SPRING ? kind : 0xff);
}

}  // namespace

TruthBuffer::TruthBuffer(const Scene& scene)
    : users_(scene.loads ? scene.loads->users : 0u),
      objects_(scene.objects.size()),
      shapes_(scene.deformables.size()),
      loads_(scene.loads ? scene.objects.size() : 0),
      pushes_(users_ * loads_.size()) {
  for (std::size_t i = 0; i < loads_.size(); ++i) loads_[i].pushes = std::span(pushes_).subspan(i * users_, users_);
}

Result<Truth> TruthBuffer::of(const tactus_truth* truth) {
  if (truth == nullptr) return refuse();
  TACTUS_TRY(const tactus_truth t, given_or(truth, tactus_truth{}));
  TACTUS_TRY(const auto objects, span_of(t.objects, t.object_count));
  TACTUS_TRY(const auto contacts, span_of(t.contacts, t.contact_count));
  TACTUS_TRY(const auto shapes, span_of(t.shapes, t.shape_count));
  TACTUS_CHECK(span_of(t.loads, t.load_count));
  TACTUS_TRY(const auto moved, span_of(t.moved, t.moved_count));
  const auto fits = [](std::size_t count, std::size_t all) { return count == 0 || count == all; };
  if (!fits(objects.size(), objects_.size()) || !fits(shapes.size(), shapes_.size()) || !fits(t.load_count, loads_.size()))
    return fail(Errc::invalid_argument, "R-API-5");
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const tactus_rigid_sample& s = objects[i];
    objects_[i] = {pose_of(s.pose), vec_of(s.velocity), vec_of(s.angular_velocity)};
  }
  contacts_.clear();
  for (const tactus_contact& contact : contacts) take(contact);
  for (std::size_t i = 0; i < shapes.size(); ++i) TACTUS_CHECK(take(shapes[i], shapes_[i]));
  if (t.load_count > 0) take_loads(t.loads);
  number_.reset();
  if (t.number != 0) number_ = t.number;
  Truth out{.objects = std::span(objects_).first(objects.size()),
            .contacts = contacts_,
            .deformables = std::span(shapes_).first(shapes.size()),
            .loads = std::span(loads_).first(t.load_count)};
  if (t.moved != nullptr) out.moved = moved;
  return out;
}

void TruthBuffer::take(const tactus_contact& contact) {
  contacts_.push_back({.kind = kind_of(contact.kind),
                       .object = contact.object,
                       .point = vec_of(contact.point),
                       .normal = vec_of(contact.normal),
                       .device = vec_of(contact.device),
                       .stiffness = contact.stiffness});
}

Result<void> TruthBuffer::take(const tactus_shape& shape, DeformableTruth& out) noexcept {
  if (shape.vertices > kMaxMeshVertices) return fail(Errc::invalid_argument, "R-API-5");
  const std::size_t vertices = shape.displacements == nullptr ? 0 : shape.vertices;
  out.displacements = std::span(shape.displacements, 3 * vertices);
  out.touch.reset();
  if (shape.touched != 0) out.touch = {.triangle = shape.triangle, .force = shape.force, .stiffness = shape.stiffness};
  return {};
}

void TruthBuffer::take_loads(const double* vectors) noexcept {
  const auto next = [&vectors]() {
    const Vec3 out{vectors[0], vectors[1], vectors[2]};
    vectors += 3;
    return out;
  };
  for (std::size_t i = 0; i < loads_.size(); ++i) {
    loads_[i].external = next();
    loads_[i].hold = next();
    for (std::size_t user = 0; user < users_; ++user) pushes_[i * users_ + user] = next();
  }
}

Answer::Answer(const Scene& scene) {
  constexpr std::size_t kMostContacts = 16;
  packets_.reserve(2 * substreams_of(scene));
  held_.reserve(2 * (scene.objects.size() + scene.deformables.size()) + kMostContacts);
}

void Answer::take(const Scene& scene, std::int64_t tick, std::span<const Packet> packets, std::span<const HeldPart> held) {
  clear();
  for (const Packet& packet : packets)
    packets_.push_back({.data = packet.bytes.data(),
                        .bytes = static_cast<std::uint32_t>(packet.bytes.size()),
                        .substream = static_cast<std::uint32_t>(packet.substream),
                        .tick = tick,
                        .number = packet.number,
                        .kind = c::kind_of(scene, packet.substream),
                        .key = packet.key,
                        .layer = static_cast<std::uint32_t>(packet.layer),
                        .reason = static_cast<std::uint32_t>(packet.reason),
                        .updates = packet.updates,
                        .reserved = 0});
  for (const HeldPart& part : held) {
    const char* const name = name_of(scene, part).data();
    held_.push_back({.part = static_cast<std::uint32_t>(part.part),
                     .index = part.index,
                     .since = part.since,
                     .rule = part.rule,
                     .name = name != nullptr ? name : ""});
  }
}

void Answer::clear() noexcept {
  packets_.clear();
  held_.clear();
}

tactus_encoded Answer::given() const noexcept {
  return {.size = 0,
          .reserved = 0,
          .packets = packets_.data(),
          .packet_count = packets_.size(),
          .held = held_.data(),
          .held_count = held_.size()};
}

}  // namespace tactus::c
