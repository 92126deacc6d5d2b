// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/exchange.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <tactus/deformable/deformable_encoder.h>
#include <tactus/load/load_syntax.h>
#include <tactus/packet/substream.h>
#include <tactus/rigid/rigid_syntax.h>

namespace tactus {
namespace {

constexpr std::uint64_t kSilence = 1'000'000;      // [us] without acknowledgements, at least, before an end sends little
constexpr std::uint64_t kSeldom = 50'000;          // [us] from datagram to datagram then
constexpr std::uint64_t kSparing = 1024;           // the wait is this part of the silence at least: numbers last for 17 minutes
constexpr std::uint32_t kSomeLoss = 65536 / 100;   // above, no acknowledgement waits long
constexpr std::int64_t kSlowestCopy = 80'000;      // [us] until the other end has the copy of a shape, if it shows later ticks
constexpr std::uint64_t kLatestShape = 120'000;    // [us] from the first sending of a shape to its copy
constexpr std::uint64_t kLatestChained = 400'000;  // [us] the same of a packet that others wait for, at least
constexpr std::uint64_t kPieceReorder = 16;        // numbers by which pieces may come out of order
constexpr std::uint64_t kBelated = 20'000;         // [us] a packet that no other waits for has a use after its tick was shown
constexpr std::int64_t kLongTrip = 80'000;         // [us] from which on there is no time for a second round of copies
constexpr std::uint64_t kInitialAckTimeout = 250'000;  // [us] while no round trip is known

std::size_t largest_packet(const Scene& scene) {
  std::size_t out = scene.moving().empty() ? 0 : max_rigid_packet(scene);
  for (const DeformableObject& object : scene.deformables) out = std::max(out, max_packet(scene, object));
  if (scene.loads) out = std::max(out, max_load_packet(scene));
  return out + 1;  // the number of its substream
}

/// 0: none may be.
std::size_t largest_chained(const Scene& scene) {
  const bool has_rigid = !scene.moving().empty() || scene.deformables.empty();  // a substream of them, with objects or none
  std::size_t out = has_rigid ? max_rigid_packet(scene) + 1 : 0;
  for (std::size_t i = 0; i < scene.deformables.size(); ++i)
    if (may_chain(scene, i + 1)) out = std::max(out, max_packet(scene, scene.deformables[i]) + 1);
  return out;
}

}  // namespace

void Exchange::send_with(Sender coder, bool repairs) {
  repairs_ = repairs;
  fixed_playout_ = playout_ > 0;
  if (direction_ == Direction::down && (copies_rigid() || !coder.scene()->deformables.empty()))
    resends_.emplace(largest_packet(*coder.scene()), coder.scene()->deformables.size() + 2);
  sender.emplace(std::move(coder));
}

void Exchange::receive_with(Receiver decoder) {
  fragments_ = Fragments(largest_packet(*decoder.scene()));
  const Scene& scene = *decoder.scene();
  if (direction_ == Direction::up) held_.emplace(largest_chained(scene));
  newest_.assign(scene.deformables.size() + 2, 0);
  heard_ = newest_;
  receiver.emplace(std::move(decoder));
}

// In

Result<std::uint64_t> Exchange::receive(std::uint64_t now, const Numbered& datagram) noexcept {
  TACTUS_TRY(const std::uint64_t number, received_.extend(datagram.number));
  if (number > received_.newest()) heard_at_ = now;
  received_.receive(number);
  ++traffic_.datagrams_heard;
  traffic_.bytes_heard += datagram.bytes.size() + kNumberedOverhead;
  return number;
}

Result<bool> Exchange::handle(const Part& part, Reading& reading) noexcept {
  if (const auto* ack = std::get_if<Acknowledgement>(&part)) {
    TACTUS_CHECK(acknowledged(*ack, reading));
    return true;
  }
  const bool drives = path && direction_ == Direction::down;
  const AckTiming ack_timing = std::holds_alternative<StatePart>(part)   ? drives ? AckTiming::soon : AckTiming::now
                               : std::holds_alternative<ClockPart>(part) ? AckTiming::never
                                                                         : AckTiming::soon;
  reading.ack_timing = std::max(reading.ack_timing, ack_timing);
  if (const auto* fragment = std::get_if<FragmentPart>(&part)) {
    TACTUS_CHECK(take(*fragment, reading));
    return true;
  }
  if (const auto* packet = std::get_if<PacketPart>(&part)) {
    const std::uint64_t number = packet->back < reading.heard.number ? reading.heard.number - packet->back : 0;
    reading.complete = decode(number, packet->bytes, reading) && reading.complete;
    return true;
  }
  return false;
}

std::uint64_t Exchange::ack_timeout() const noexcept {
  if (!sent_.round_trip()) return kInitialAckTimeout;
  const RoundTrip& trip = *sent_.round_trip();
  const std::uint64_t held = direction_ == Direction::down ? kUpAckDelay : path ? kDrivenAckDelay : kDownAckDelay;
  return static_cast<std::uint64_t>(trip.smoothed + 4 * trip.variation) + held;
}

ReceivedNumbers::AckDelay Exchange::own_ack_delay() const noexcept {
  if (direction_ == Direction::up) return {kUpAckDelay, kUpAckDelay};
  return {kDownAckDelay, path && sent_.loss() <= kSomeLoss ? kDrivenAckDelay : kDownAckDelay};
}

void Exchange::report_link() noexcept {
  if (!sender || !sent_.round_trip()) return;
  const std::int64_t tick_rate = sender->scene()->tick_rate;
  const auto timeout = (static_cast<std::int64_t>(ack_timeout()) * tick_rate + 999'999) / 1'000'000;
  sender->set_link({.ack_timeout = std::max<std::int64_t>(1, timeout),
                    .loss = std::ldexp(sent_.loss(), -16),
                    .copies = rigid_comes_in_time(),
                    .waits = waits_});
}

void Exchange::set_waits(bool waits) noexcept {
  if (std::exchange(waits_, waits) != waits) report_link();
}

Result<void> Exchange::acknowledged(const Acknowledgement& ack, Reading& reading) noexcept {
  const auto arrived = [&](std::uint64_t number) {
    progress_at_ = reading.now;
    const Slot& slot = slots_[number % slots_.size()];
    if (slot.number != number) return;
    if (pieces && slot.piece > 0) {
      pieces->arrived(slot.piece - 1);
      pieces->pacer.arrived();
      timeouts_ = 0;
    }
    if (!sender) return;
    for (std::size_t i = 0; i < slot.count && resends_; ++i) resends_->arrived(slot.kept[i], number);
    const bool waits = slot.fragment.number != 0 &&
                       !sent_fragments_.arrived(slot.fragment.number, slot.packets[0].substream, slot.fragment.index);
    for (std::size_t i = 0; i < slot.count && !waits; ++i)
      sender->acknowledge(slot.packets[i].substream, number - slot.packets[i].back);
  };
  const auto lost = [&](std::uint64_t number) {
    ++traffic_.lost;
    const Slot& slot = slots_[number % slots_.size()];
    if (pieces && slot.number == number && slot.piece > 0) pieces->lost(slot.piece - 1);
    wants_key_ = wants_key_ || (slot.number == number && slot.layered);
    lose(number, reading.now);
  };
  TACTUS_CHECK(sent_.acknowledge(ack, reading.now, arrived, lost));
  if (pieces && sent_.round_trip())
    sent_.lose(kPieceReorder,
               reading.now - static_cast<std::uint64_t>(sent_.round_trip()->smoothed * 5 / 4 + sent_.round_trip()->variation),
               lost);
  if (path && direction_ == Direction::up)
    path->settle(sent_.highest_acknowledged(), [this](std::uint64_t number) { return sent_.has_arrived(number); });
  reading.heard.round_trip = sent_.sample();
  if (sent_.sample()) report_link();
  if (sent_.sample() && pieces) update_pacer(ack, reading.now);
  return {};
}

void Exchange::update_pacer(const Acknowledgement& ack, std::uint64_t now) noexcept {
  const std::int64_t arrived = static_cast<std::int64_t>(now) - std::int64_t{16} * ack.held;
  pieces->pacer.feedback({.number = sent_.highest_acknowledged(),
                          .newest_sent = sent_.newest(),
                          .sent = arrived - *sent_.sample(),
                          .arrived = arrived},
                         *sent_.round_trip(), now);
}

/// A packet of this datagram, or one that it completed.   in   number  0: of no datagram
bool Exchange::decode(std::uint64_t number, std::span<const std::uint8_t> packet, Reading& reading) noexcept {
  const auto decoded = receiver && number > 0 ? receiver->push(number, packet) : tl::unexpected(Error{});
  if (!decoded) {
    if (receiver && number > 0 && receiver->holds(number, packet)) return true;  // it came before
    if (hold(number, packet, decoded.error(), reading.now)) return true;
    ++traffic_.packets_refused;
    return false;
  }
  reading.heard.tick = std::max(reading.heard.tick.value_or(decoded->tick), decoded->tick);
  if (path && direction_ == Direction::down && path->add(number, receiver->object_after(*decoded, 0)) <= 0) {
    ++traffic_.packets_refused;
    return false;
  }
  const std::size_t substream = decoded->substream;
  if (is_of_deformable(*receiver->scene(), substream)) reading.ack_timing = AckTiming::now;
  if ((substream == 0 || waits_for(substream)) && number < std::min(heard_[substream], reading.heard.number)) {
    reading.heard.has_copy = true;
  } else {
    reading.heard.newest = std::max(reading.heard.newest.value_or(decoded->tick), decoded->tick);
    reading.heard.oldest = std::min(reading.heard.oldest.value_or(decoded->tick), decoded->tick);
  }
  took(*decoded, packet.size(), reading);
  if (held_ && !held_->empty()) take_held(substream, reading);
  return true;
}

/// What every decoded packet changes.
bool Exchange::took(const DecodedPacket& decoded, std::size_t size, Reading& reading) noexcept {
  ++traffic_.packets_heard;
  traffic_.payload_heard += size;
  if (decoded.number > newest_[decoded.substream]) {
    newest_[decoded.substream] = decoded.number;
    if (direction_ == Direction::up && decoded.number % kHashEvery == 0 && decoded.layer == Layer::all) {
      const auto hash = static_cast<std::uint32_t>(receiver->state_hash(decoded.substream));
      reading.heard.hash =
          HashPart{static_cast<std::uint8_t>(decoded.substream), static_cast<std::uint16_t>(decoded.number), hash};
    }
  }
  heard_[decoded.substream] = std::max(heard_[decoded.substream], decoded.number);
  if (decoded.substream == 0 && repaired_ && held_ && decoded.baseline > 0)
    for (std::uint64_t number = decoded.baseline + 1; number < decoded.number; ++number) receiver->skip_number(number);
  return true;
}

/// Packets of this substream that come build on the one before.
bool Exchange::waits_for(std::uint64_t substream) const noexcept {
  return held_ && repaired_ && may_chain(*receiver->scene(), substream);
}

/// A chained packet whose baseline is not there waits for it. One that is older than what is decoded is no use any more.
bool Exchange::hold(std::uint64_t number, std::span<const std::uint8_t> packet, const Error& error, std::uint64_t now) noexcept {
  if (number == 0 || error.code != Errc::state) return false;
  const auto part = split_substream(*receiver->scene(), packet);
  if (!part || !waits_for(part->substream)) return false;
  if (number <= newest_[part->substream]) return true;
  held_->remove_if([now](const HeldPackets::Held& held) { return now > held.at + HeldPackets::kLongest; });
  if (!held_->hold(number, part->substream, packet, now)) return false;
  heard_[part->substream] = std::max(heard_[part->substream], number);
  return true;
}

/// Those of a substream whose baseline has come, in the order of their numbers: each may be the baseline of the next.
void Exchange::take_held(std::size_t substream, Reading& reading) noexcept {
  held_->remove_if([&](const HeldPackets::Held& held) {
    if (held.substream != substream) return false;
    if (held.number <= newest_[held.substream]) return true;  // older than a key packet
    const auto decoded = receiver->push(held.number, held_->bytes(held));
    if (!decoded) {
      const bool waits = decoded.error().code == Errc::state;
      if (!waits) ++traffic_.packets_refused;
      return !waits;
    }
    reading.heard.tick = std::max(reading.heard.tick.value_or(decoded->tick), decoded->tick);
    took(*decoded, held.size, reading);
    const Heard::Arrival arrival{decoded->tick, held.at};
    const auto lead = [rate = receiver->scene()->tick_rate](const Heard::Arrival& a) {
      return static_cast<std::int64_t>(a.at) - a.tick * 1'000'000 / rate;
    };
    if (!reading.heard.held) reading.heard.held = {arrival, arrival};
    auto& [fastest, slowest] = *reading.heard.held;
    if (lead(arrival) < lead(fastest)) fastest = arrival;
    if (lead(arrival) > lead(slowest)) slowest = arrival;
    return true;
  });
}

Result<void> Exchange::take(const FragmentPart& fragment, Reading& reading) noexcept {
  TACTUS_TRY(const auto taken, fragments_.take(reading.heard.number, fragment));
  reading.complete = taken.kept;
  if (!taken.complete) return {};
  reading.complete = decode(taken.complete->number, taken.complete->packet, reading);
  if (reading.complete) fragments_.decoded(*taken.complete);
  else fragments_.refused(*taken.complete, static_cast<std::size_t>(fragment.index));
  return {};
}

void Exchange::finish(const Reading& reading) noexcept {
  if (!reading.complete) return;
  received_.accept(reading.heard.number, reading.now, reading.ack_timing, own_ack_delay());
  if (receiver) receiver->skip_number(reading.heard.number);
}

// Out

bool Exchange::add_piece(DatagramWriter& writer, std::uint64_t number, std::uint64_t now) noexcept {
  const std::uint64_t index = *pieces->next();
  if (!writer.add(PiecePart{index, pieces->bytes(index)})) return false;
  slots_[number % slots_.size()].piece = static_cast<std::uint32_t>(index + 1);
  pieces->sent(index);
  pieces->pacer.sent(number, now);
  return true;
}

std::optional<std::uint64_t> Exchange::pieces_due() const noexcept {
  if (!pieces || pieces->in_flight() == 0) return std::nullopt;
  const auto oldest = sent_.oldest();
  return oldest ? std::optional(*oldest + (ack_timeout() << timeouts_)) : std::nullopt;
}

void Exchange::expire_pieces(std::uint64_t now) noexcept {
  const auto due = pieces_due();
  if (!due || now < *due) return;
  sent_.expire(now - (ack_timeout() << timeouts_), [this](std::uint64_t number) {
    const Slot& slot = slots_[number % slots_.size()];
    if (slot.number == number && slot.piece > 0) pieces->lost(slot.piece - 1);
  });
  pieces->pacer.timed_out();
  timeouts_ = std::min(timeouts_ + 1, sent_.round_trip() ? 1u : 6u);
}

std::optional<std::uint64_t> Exchange::due() const noexcept {
  std::optional<std::uint64_t> out = received_.due();
  for (const auto& due : {resends_ ? resends_->due() : std::nullopt, tail_due()})
    if (due) out = std::min(out.value_or(next_send(*due)), next_send(*due));
  return out;
}

/// Packets that nobody took are lost, and so are their numbers: submit() skips them.
void Exchange::give_up() noexcept {
  for (; has_packets(); ++next_packet_) {
    const Packet& packet = packets_[next_packet_];
    ++traffic_.packets_held;
    wants_key_ = wants_key_ || packet.layer != Layer::all;
    if (chains(packet.substream)) resends_->break_chain(packet.substream);
  }
  packets_ = {};
  next_packet_ = next_fragment_ = 0;
}

void Exchange::skip_number(std::uint64_t now) noexcept {
  const std::uint64_t number = *sent_.next();
  slots_[number % slots_.size()] = {.number = number};
  sent_.send(now);
}

/// The layers of a mesh build on each other: once one is lost, the other end refuses the rest, and acknowledges nothing that would show it.
bool Exchange::misses_layers(std::uint64_t now) const noexcept {
  return layered_ > sent_.highest_acknowledged() && now > std::max(progress_at_, key_wanted_at_) + 2 * ack_timeout();
}

/// Nothing was acknowledged for long.
bool Exchange::is_cut_off(std::uint64_t now) const noexcept {
  return eliciting_ > sent_.highest_acknowledged() && now > progress_at_ + std::max(kSilence, 4 * ack_timeout());
}

std::uint64_t Exchange::next_send(std::uint64_t wanted) const noexcept {
  if (!is_cut_off(wanted)) return wanted;
  const std::uint64_t silent = std::max(sent_at_, progress_at_) - progress_at_;
  return std::max(wanted, sent_at_ + std::max(kSeldom, silent / kSparing));
}

Result<std::span<const Packet>> Exchange::submit(std::uint64_t now, std::int64_t tick, const Truth& truth) noexcept {
  give_up();
  while (sent_.next() && *sent_.next() <= newest_packet_) skip_number(now);  // a packet had it that went when there was none left
  const auto number = sent_.next();
  if (!sender || !number) return packets_;
  if (!may_send(now)) {
    ++traffic_.ticks_held;
    return packets_;
  }
  if (misses_layers(now)) wants_key_ = true;
  if (std::exchange(wants_key_, false)) {
    sender->request_key();
    key_wanted_at_ = now;
  }
  begin_chains(now);
  TACTUS_TRY(packets_, sender->encode(tick, truth, *number));
  for (const Packet& packet : packets_) newest_packet_ = std::max(newest_packet_, packet.number);
  if (path && direction_ == Direction::up && !packets_.empty()) path->add(packets_[0].number, sender->object(0));
  return packets_;
}

std::optional<std::uint64_t> Exchange::begin(std::uint64_t now, bool wanted) noexcept {
  const auto number = sent_.next();
  if (!number) return std::nullopt;
  writer_.begin(*number);
  slots_[*number % slots_.size()] = {.number = *number};
  if (received_.can_acknowledge() && (received_.has_news() || wanted)) writer_.add(received_.acknowledge(now));
  return number;
}

bool Exchange::add_whole(const Packet& packet, std::uint64_t number, std::uint64_t now) noexcept {
  if (!writer_.add(PacketPart{number - packet.number, packet.bytes})) return false;
  Slot& slot = slots_[number % slots_.size()];
  slot.kept[slot.count] = keep(number, packet, {.bytes = packet.bytes}, now);
  ++next_packet_;
  return true;
}

/// A piece of a packet that is too large for one datagram.
bool Exchange::add_fragment(const Packet& packet, std::uint64_t number, std::uint64_t now) noexcept {
  const std::size_t count = (packet.bytes.size() + kFragmentSize - 1) / kFragmentSize, index = next_fragment_;
  const std::size_t begin = index * kFragmentSize;
  const auto bytes = packet.bytes.subspan(begin, std::min(kFragmentSize, packet.bytes.size() - begin));
  if (!writer_.add(FragmentPart{number - packet.number, packet.substream, index, count, bytes})) return false;
  if (index == 0) sent_fragments_.send(packet, count);
  Slot& slot = slots_[number % slots_.size()];
  slot.fragment = {packet.number, static_cast<std::uint16_t>(index)};
  slot.kept[slot.count] = keep(number, packet, {index, count, bytes}, now);
  next_fragment_ = (index + 1) % count;
  if (next_fragment_ == 0) ++next_packet_;
  return true;
}

/// A copy that no packet waits for.
bool Exchange::rigid_comes_in_time() const noexcept {
  return !repairs_ && fixed_playout_ && sent_.round_trip() && ack_timeout() <= playout_;
}

bool Exchange::may_copy(std::uint64_t substream) const noexcept {
  return substream == 0 ? repairs_ || rigid_comes_in_time() : is_of_deformable(*sender->scene(), substream);
}

/// Packets of this substream that go build on the one before.
bool Exchange::chains(std::uint64_t substream) const noexcept { return repairs_ && may_chain(*sender->scene(), substream); }

std::uint16_t Exchange::keep(std::uint64_t number, const Packet& packet, const Resends::Portion& portion,
                             std::uint64_t now) noexcept {
  traffic_.payload_sent += portion.bytes.size();
  if (!resends_ || !may_copy(packet.substream) || packet.layer != Layer::all) return Resends::kNone;
  const bool is_chained = chains(packet.substream);
  if (is_chained && packet.key && portion.index == 0) resends_->settle_chain(packet.substream, packet.number);
  return resends_->keep(number, packet, portion, now, is_chained);
}

/// Or else clients would show the past for nothing.
bool Exchange::shapes_come_in_time() const noexcept {
  const auto& trip = sent_.round_trip();
  const auto most = std::max(kSlowestCopy, static_cast<std::int64_t>(playout_));
  return trip && trip->smoothed + 4 * trip->variation + trip->least / 2 <= most;
}

/// A shape has a use until its tick is shown, and a little longer a packet of rigid objects. In a chain all wait for one that is missing; but
/// after an outage a key packet is there sooner than all of them.
Resends::Latest Exchange::latest() const noexcept {
  const auto one_way = static_cast<std::uint64_t>(sent_.round_trip()->least / 2);
  return {.chained = std::max({kLatestChained, 4 * ack_timeout(), 2 * playout_}),
          .rigid = one_way + playout_ + kBelated,
          .shape = shapes_come_in_time() ? std::max(kLatestShape, playout_) : 0,
          .one_way = one_way};
}

/// Where all packets wait for one whose copies are lost, too, and another round takes long, there are more of them.
unsigned Exchange::copies_of(std::uint64_t substream) const noexcept {
  if (!chains(substream)) return substream == 0 ? 1 : 2;
  return sent_.round_trip() && sent_.round_trip()->least >= kLongTrip ? 3 : 2;
}

void Exchange::lose(std::uint64_t number, std::uint64_t now) noexcept {
  const Slot& slot = slots_[number % slots_.size()];
  if (!resends_ || slot.number != number) return;
  for (std::size_t i = 0; i < slot.count; ++i) {
    const PacketName& name = slot.packets[i];
    resends_->lost(slot.kept[i], number, now, copies_of(name.substream));
    if (chains(name.substream) && !resends_->keeps(slot.kept[i], number)) resends_->miss(name.substream, number - name.back);
  }
}

const Resends::Kept* Exchange::next_copy(std::uint64_t now) noexcept {
  if (!resends_ || !sent_.round_trip() || !may_send(now)) return nullptr;
  return resends_->next(now, latest());
}

/// [us] when the newest ack-eliciting datagram counts as lost: none after it would show it.
std::optional<std::uint64_t> Exchange::tail_due() const noexcept {
  if (!copies_rigid() || !sent_.round_trip() || eliciting_ <= sent_.highest_acknowledged()) return std::nullopt;
  return std::max(eliciting_at_, tail_at_) + ack_timeout();
}

void Exchange::watch_tail(std::uint64_t now) noexcept {
  const auto due = tail_due();
  if (!due || now < *due) return;
  tail_at_ = now;
  lose(eliciting_, now);
}

void Exchange::want_key(std::uint64_t now) noexcept {
  if (now >= chains_at_ + ack_timeout()) wants_chains_ = true;
}

void Exchange::begin_chains(std::uint64_t now) noexcept {
  if (!repairs_) return;
  if (std::exchange(wants_chains_, false)) {
    for (std::size_t i = 0; i <= sender->scene()->deformables.size(); ++i)
      if (chains(i)) resends_->break_chain(i);
    chains_at_ = now;
  }
  if (is_cut_off(now)) return sender->request_key(0);  // the first that gets through is then enough; shapes wait until one does
  while (const auto broken = resends_->poll_broken()) sender->request_key(*broken);
}

/// As many as fit of the packets that are lost and not too old, or one fragment.
bool Exchange::add_copies(std::uint64_t number, std::uint64_t now) noexcept {
  Slot& slot = slots_[number % slots_.size()];
  bool added = false;
  while (slot.count < slot.packets.size()) {
    const Resends::Kept* const copy = next_copy(now);
    if (copy == nullptr || (copy->count > 1 && slot.count > 0) || !add_copy(*copy, number)) break;
    traffic_.payload_sent += copy->size;
    slot.kept[slot.count] = resends_->sent(*copy, number, now);
    slot.packets[slot.count++] = {copy->substream, static_cast<std::uint16_t>(number - copy->number)};
    added = true;
  }
  return added;
}

bool Exchange::add_copy(const Resends::Kept& copy, std::uint64_t number) noexcept {
  const std::uint64_t back = number - copy.number;
  if (copy.count == 1) {
    if (!writer_.add(PacketPart{back, resends_->bytes(copy)})) return false;
    ++traffic_.packets_sent;
    return true;
  }
  if (!writer_.add(FragmentPart{back, copy.substream, copy.index, copy.count, resends_->bytes(copy)})) return false;
  slots_[number % slots_.size()].fragment = {copy.number, copy.index};
  return true;
}

/// As many of the waiting packets as fit, or one fragment.
bool Exchange::add_packets(std::uint64_t number, std::uint64_t now) noexcept {
  Slot& slot = slots_[number % slots_.size()];
  bool added = false, cut = false;
  while (has_packets() && !cut && packets_[next_packet_].number <= number && slot.count < slot.packets.size()) {
    const Packet& packet = packets_[next_packet_];
    if (packet.bytes.size() > kFragmentSize * kMostFragments) {
      if (chains(packet.substream)) resends_->break_chain(packet.substream);
      ++traffic_.packets_held;
      ++next_packet_;
      continue;
    }
    cut = packet.bytes.size() > kFragmentSize;
    if (cut ? added || !add_fragment(packet, number, now) : !add_whole(packet, number, now)) break;
    if (next_fragment_ == 0) ++traffic_.packets_sent;
    slot.packets[slot.count++] = {static_cast<std::uint16_t>(packet.substream),
                                  static_cast<std::uint16_t>(number - packet.number)};
    slot.layered = slot.layered || packet.layer != Layer::all;
    if (slot.layered) layered_ = number;
    added = true;
  }
  return added;
}

std::span<const std::uint8_t> Exchange::end(std::uint64_t now, bool is_eliciting) noexcept {
  const std::uint64_t number = *sent_.next();
  is_eliciting = add_packets(number, now) || is_eliciting;
  is_eliciting = add_copies(number, now) || is_eliciting;
  if (writer_.empty()) {  // all were too large
    skip_number(now);
    return {};
  }
  if (is_eliciting && eliciting_ <= sent_.highest_acknowledged()) progress_at_ = now;
  if (is_eliciting) eliciting_ = number, eliciting_at_ = now;
  sent_.send(now);
  sent_at_ = now;
  const auto datagram = writer_.finish(epoch_);
  ++traffic_.datagrams_sent;
  traffic_.bytes_sent += datagram.size();
  return datagram;
}

}  // namespace tactus
