// SPDX-License-Identifier: Apache-2.0
/// What a client does with the datagrams of a server, made field by field.
#include <functional>
#include <string>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"
#include "conformance/make_vectors/session_build.h"

namespace tactus::conformance {
namespace {

/// Lines for a client, and a server that makes them.
class Script {
 public:
  explicit Script(const RawHeader& header = objects(1)) : stream_(header), declaration_(header.bytes()) {
    line("\"join\":\"" + hex(little(kNonce), true) + '"');
  }

  static RawHeader objects(std::size_t count) {
    RawHeader header{.objects = {}};
    for (std::size_t i = 0; i < count; ++i) header.objects.push_back({.name = "object " + std::to_string(i)});
    header.baseline_span = 64;
    return header;
  }

  Script& heard(const Bytes& datagram) { return line("\"heard\":\"" + hex(datagram) + '"'); }
  Script& leaves() { return line("\"leave\":1"); }
  Script& pass(std::uint64_t milliseconds) {
    time_ += 1000 * milliseconds;
    return *this;
  }
  Script& welcome(std::uint64_t serial = 0, std::uint64_t epoch = kEpoch, std::uint64_t nonce = kNonce) {
    epoch_ = epoch;
    return heard(welcome_for(serial, epoch, nonce, declaration_.size(), hash_of(declaration_)));
  }
  Bytes welcome_for(std::uint64_t serial, std::uint64_t epoch, std::uint64_t nonce, std::uint64_t size,
                    std::uint64_t hash) const {
    return with_check(head(0, 1) + little(nonce) + varint(serial) + little(epoch) + little(std::uint16_t{3}) + varint(size) +
                          little(hash) + varint(77),
                      0);
  }
  Script& refusal(std::uint8_t reason, std::uint64_t nonce = kNonce) {
    return heard(with_check(head(0, 2) + little(nonce) + Bytes{reason}, 0));
  }
  Script& parts(std::uint64_t number, const Bytes& all) { return heard(with_check(head(1, number) + all, epoch_)); }
  Script& packet(std::uint64_t number, const Bytes& packet) { return heard(with_check(head(2, number) + packet, epoch_)); }
  Bytes piece(std::size_t index) const {
    const std::size_t begin = kPieceSize * index;
    const auto end = declaration_.begin() + static_cast<std::ptrdiff_t>(std::min(begin + kPieceSize, declaration_.size()));
    return part(4, varint(index) + Bytes(declaration_.begin() + static_cast<std::ptrdiff_t>(begin), end));
  }
  std::size_t pieces() const { return (declaration_.size() + kPieceSize - 1) / kPieceSize; }
  /// Welcome and all pieces, with numbers from 1.
  Script& live() {
    welcome();
    for (std::size_t i = 0; i < pieces(); ++i) parts(i + 1, piece(i));
    return *this;
  }
  /// The packet of this number: object 0 moves on.
  Bytes moved(std::uint64_t number, std::uint32_t baseline = 1, bool key = false) {
    const auto n = static_cast<std::int32_t>(number);
    return made({.tick = static_cast<std::int64_t>(10 * number),
                 .updates = {{0, Reason::visual, 0, {{{100 * n, -7 * n, n}, {n, 0, 3}, {5 * n, 1, 0}, {}}}}},
                 .key = key,
                 .baseline = baseline,
                 .sequence = static_cast<std::uint16_t>(number)});
  }
  /// A packet of all objects that is too large for a datagram.
  Bytes large(std::uint64_t number, std::uint64_t seed) {
    Random random(seed);
    Step step{.tick = static_cast<std::int64_t>(10 * number),
              .updates = {},
              .key = true,
              .sequence = static_cast<std::uint16_t>(number)};
    for (std::uint32_t i = 0; i < stream_.header().objects.size(); ++i)
      step.updates.push_back(random_update(random, stream_.header(), i));
    return made(step);
  }
  Input text() const { return Bytes(text_.begin(), text_.end()); }
  const Bytes& declaration() const { return declaration_; }

 private:
  Bytes made(const Step& step) {
    const Bytes packet = stream_.packet(step);
    return Bytes(packet.begin() + 2, packet.end());  // the session knows its number
  }
  Script& line(const std::string& said) {
    text_ += "{\"at\":" + std::to_string(time_) + ',' + said + "}\n";
    time_ += 16'011;
    return *this;
  }

  Stream stream_;
  Bytes declaration_;
  std::string text_;
  std::uint64_t time_ = 5'000'000, epoch_ = kEpoch;
};

std::vector<Bytes> cut(const Bytes& packet) {
  std::vector<Bytes> out;
  for (std::size_t begin = 0; begin < packet.size(); begin += kFragmentSize)
    out.emplace_back(packet.begin() + static_cast<std::ptrdiff_t>(begin),
                     packet.begin() + static_cast<std::ptrdiff_t>(std::min(begin + kFragmentSize, packet.size())));
  return out;
}

void add_joining(Catalogue& catalogue) {
  catalogue.section(section::kJoining);
  const auto script = [&](const char* name, const char* what, const std::function<void(Script&)>& make,
                          std::vector<std::string> rules = {}) {
    Script s;
    make(s);
    catalogue.session(name, what, s.text(), std::move(rules));
  };
  script("refused", "A refusal for another nonce, then one for this.",
         [](Script& s) { s.refusal(2, kNonce + 1).refusal(2).refusal(3); });
  script("welcome-of-another", "A welcome for another nonce, then one for this, again, and a refusal that comes too late.",
         [](Script& s) { s.welcome(0, kEpoch, kNonce ^ 1).welcome().welcome(0, kEpoch + 1).refusal(2); });
  script("one-piece", "A declaration of one piece: live.", [](Script& s) { s.live(); });
  script("left", "The server leaves while the client is live; it is over.",
         [](Script& s) { s.live().heard(with_check(head(0, 3) + Bytes{4}, kEpoch)); });
  script("leaves", "The client leaves.", [](Script& s) { s.live().leaves(); });
  script("leaves-while-joining", "Who has not been welcomed has nothing to leave.", [](Script& s) { s.leaves(); });
  script("new-epoch", "A welcome with a higher serial replaces the scene; numbers, acknowledgements and states begin anew.",
         [](Script& s) {
           s.live().packet(2, s.moved(2, 1, true)).welcome(1, kEpoch + 9).packet(3, s.moved(3, 1, true)).parts(1, s.piece(0));
           s.packet(2, s.moved(2, 1, true)).welcome(1, kEpoch + 10);
         });
  script("other-checks", "Checks of another direction, another epoch, and none at all.",
         [](Script& s) {
           const Bytes body = head(2, 2) + s.moved(2, 1, true);
           s.live().heard(with_check(body, kEpoch, 0)).heard(with_check(body, kEpoch + 1)).heard(with_check(body, 0)).heard(body);
           s.heard({}).heard(Bytes(5, 0)).heard(with_check(body, kEpoch));
         },
         {"R-SES-1"});
  script("forms-and-kinds", "A join and an unknown handshake that come down, form 3, and a datagram of 1201 bytes.",
         [](Script& s) {
           s.live().heard(with_check(head(0, 0) + little(kNonce) + Bytes(60, 0), 0)).heard(with_check(head(0, 7), kEpoch));
           s.heard(with_check(head(3, 2) + Bytes{1, 2, 3}, kEpoch)).heard(with_check(head(2, 2) + Bytes(1195, 1), kEpoch));
         },
         {"R-SES-2"});
  script("handshakes-cut", "Handshakes that end early or go on, and a varint that is too long.",
         [](Script& s) {
           s.heard(with_check(head(0, 2) + little(kNonce), 0)).heard(with_check(head(0, 2) + little(kNonce) + Bytes{2, 2}, 0));
           const Bytes whole = s.welcome_for(0, kEpoch, kNonce, 100, 1), body = without_last(whole, 4);
           s.heard(with_check(without_last(body, 1), 0)).heard(with_check(body + Bytes{0}, 0));
           s.heard(with_check(head(0, 1) + little(kNonce) + Bytes(11, 0x80), 0)).live().heard(with_check(head(0, 3), kEpoch));
         },
         {"R-SES-3"});
}

void add_numbers(Catalogue& catalogue) {
  catalogue.section(section::kAcknowledgements);
  Script in_order;
  in_order.live();
  for (std::uint64_t n = 2; n < 8; ++n) in_order.packet(n, in_order.moved(n, 1, n == 2));
  catalogue.session("packets", "Packets one after the other; each is acknowledged.", in_order.text());

  Script gaps;
  gaps.live();
  for (const std::uint64_t n : {2u, 3u, 5u, 8u, 6u, 8u, 5u, 80u, 79u, 15u, 16u, 144u}) gaps.packet(n, gaps.moved(n, 1, true));
  catalogue.session("gaps", "Missing numbers, 64 back and more, some that come later, some twice.", gaps.text(), {"R-SES-4"});

  Script far;
  far.live();
  for (const std::uint64_t n :
       {1000u, 2u, 1025u, 2u, 3000u, 1977u, 1976u, 2500u, 7000u, 11000u, 15000u, 16383u, 16384u, 16390u, 20000u, 16384u, 19500u})
    far.packet(n, far.moved(n, 1, true));
  catalogue.session("far-numbers", "Numbers beyond 14 bits, 1023 back and 1024 back.", far.text(), {"R-SES-4"});

  Script ahead;
  ahead.live();
  for (const std::uint64_t n : {1u + 4096u, 1u + 8192u, 1u + 8192u + 4097u, 1u + 8192u + 4096u})
    ahead.packet(n, ahead.moved(n, 1, true));
  catalogue.session("ahead", "Jumps ahead by as much as 14 bits can tell, and by one more.", ahead.text());

  Script quiet;
  quiet.live().parts(2, clock()).parts(3, acknowledgement(1, 0) + clock()).parts(4, part(64, {1, 2}) + part(255, {}));
  quiet.packet(5, quiet.moved(5, 1, true)).parts(6, clock());
  catalogue.session("quiet",
                    "Acknowledgements and clocks ask for nothing; other parts do, and what is acknowledged then tells of all.",
                    quiet.text());

  Script refused;
  refused.live().packet(2, refused.moved(2, 1, true)).packet(3, refused.moved(3, 9)).packet(4, Bytes{0xff, 0xff, 0xff});
  refused.packet(5, refused.moved(5, 3))
      .parts(6, packet_part(refused.moved(6, 1, true), 0) + packet_part(refused.moved(6, 4), 0));
  refused.packet(7, refused.moved(7, 2));
  catalogue.session("refused-packets",
                    "Packets that build on nothing, or are none, are not acknowledged; those beside them count.", refused.text());

  Script never;
  never.live().parts(2, acknowledgement(0, 0)).parts(3, acknowledgement(500, 0)).parts(4, acknowledgement(0xffff, 0));
  never.parts(5, acknowledgement(500, 0) + packet_part(never.moved(5, 1, true), 0) + packet_part(never.moved(5, 1, true), 4));
  catalogue.session("never-sent", "Acknowledgements of numbers that the client has not used; what follows them has no effect.",
                    never.text(), {"R-SES-6"});

  Script wide;
  wide.live();
  for (std::uint64_t n = 4000; n <= 72'000; n += 4000) wide.packet(n, wide.moved(n, 1, true));
  wide.packet(72'001, wide.moved(72'001)).packet(72'064, wide.moved(72'064, 64)).packet(72'065, wide.moved(72'065, 65));
  wide.packet(72'128, wide.moved(72'128, 64)).packet(76'160, wide.moved(76'160, 4095)).packet(76'161, wide.moved(76'161, 4096));
  catalogue.session("wide-numbers", "Numbers of more than 16 bits, hashes among them, and baselines 64, 65, 4095 and 4096 back.",
                    wide.text());

  Script both;
  both.live().packet(2, both.moved(2, 1, true)).parts(2, Bytes{2}).parts(2, part(9, {})).parts(2, acknowledgement(500, 0));
  both.parts(3, acknowledgement(500, 0) + Bytes{8, 9})
      .parts(3, part(0, {}) + Bytes{9})
      .parts(4, Bytes{9, 5})
      .parts(5, Bytes{3, 9, 1});
  both.parts(6, packet_part(both.moved(6, 1, true), 0) + Bytes{0, 1}).parts(7, fragment(0, 0, 1, {1}) + Bytes{64, 9});
  catalogue.session("two-rules", "Datagrams that break two rules: syntax first, then the number, then what the parts say.",
                    both.text(), {"R-SES-3", "R-SES-4", "R-SES-5"});

  Script hashes;
  hashes.live();
  for (const std::uint64_t n : {62u, 63u, 64u, 65u, 127u, 129u, 128u, 192u}) hashes.packet(n, hashes.moved(n, 1, true));
  catalogue.session("hashes", "Numbers that 64 divides, one of them overtaken: the state's hash is told.", hashes.text());

  Script held;
  held.live().packet(2, held.moved(2, 1, true)).pass(100).parts(3, packet_part(held.moved(2, 1, true), 1));
  held.pass(900).packet(4, Bytes{}).packet(5, held.moved(5, 3));
  catalogue.session("held", "The time since the newest came, when older ones ask again.", held.text());

  Script overtaken;
  overtaken.live().packet(2, overtaken.moved(2, 1, true));
  const Bytes third = overtaken.moved(3, 1), fourth = overtaken.moved(4, 2), fifth = overtaken.moved(5, 2);
  overtaken.packet(4, fourth).packet(5, fifth).packet(3, third).packet(5, fifth);
  overtaken.parts(6, packet_part(fourth, 2) + packet_part(overtaken.moved(6, 1), 0));
  catalogue.session("overtaken", "Packets overtake each other and come again in other datagrams.", overtaken.text());
}

void add_parts(Catalogue& catalogue) {
  catalogue.section(section::kDatagram);
  Script order;
  const auto key = [&order](std::uint64_t n) { return order.moved(n, 1, true); };
  order.live().parts(2, packet_part(key(2), 0) + clock()).parts(3, part(0, {1})).parts(4, part(9, {1})).parts(5, part(63, {1}));
  order.parts(7, part(5, {1})).parts(8, part(6, Bytes(7, 0))).parts(9, {}).parts(10, packet_part(key(10), 0));
  order.parts(11, part(64, {}) + clock())
      .parts(12, clock() + clock() + packet_part(key(12), 0))
      .parts(13, part(70, {}) + part(69, {}));
  catalogue.session("orders", "Parts out of order, unknown, for the other direction, none, and a single packet that has form 2.",
                    order.text(), {"R-SES-5"});

  Script paces;
  const auto pace = [](std::uint64_t from, std::uint64_t offset) { return part(3, varint(from) + varint(offset)); };
  constexpr std::uint64_t kEnd = std::uint64_t{1} << 32, kFar = std::uint64_t{1} << 34;  // of `from`; of `offset`, as zigzag
  paces.live().parts(2, pace(0, 0)).parts(3, pace(7, 1) + pace(9, kFar)).parts(4, pace(kEnd - 1, kFar - 1));
  paces.parts(5, pace(kEnd, 0)).parts(6, pace(0, kFar + 1)).parts(7, pace(0, kFar + 2)).parts(8, part(3, {1}));
  paces.parts(9, part(3, {1, 1, 1})).parts(10, part(3, {1, 0x80, 0})).parts(11, part(3, Bytes(8, 0)));
  paces.parts(12, clock() + pace(3, 4) + packet_part(paces.moved(12, 1, true), 0)).parts(13, pace(1, 2) + clock());
  catalogue.session("paces", "Paces of a device, at their limits and beyond, cut, out of order, and before a packet.",
                    paces.text(), {"R-SES-3", "R-SES-5"});

  Script cut_parts;
  cut_parts.live()
      .parts(2, Bytes{2})
      .parts(3, Bytes{2, 5, 1})
      .parts(4, part(2, {}))
      .parts(5, part(2, {1, 1}))
      .parts(6, part(1, {1, 0, 1}));
  cut_parts.parts(7, part(1, {1, 0, 1, 0, 0, 0}))
      .parts(8, part(2, {0x80, 0}))
      .parts(9, part(4, {}))
      .parts(10, Bytes{64, 0x80, 0x80});
  cut_parts.parts(11, part(8, {})).parts(12, clock() + part(7, {0, 0}));
  catalogue.session("parts-cut", "Parts that end early or have bytes too many, and varints that are not the shortest.",
                    cut_parts.text(), {"R-SES-3"});

  Script sizes;
  sizes.live();
  const auto filled = [](std::size_t datagram) { return part(64, Bytes(datagram - 2 - 4 - 3, 7)); };
  const Bytes whole = packet_part(sizes.moved(2, 1, true), 0);
  sizes.parts(2, whole + filled(1200 - whole.size())).parts(3, whole + filled(1201 - whole.size())).packet(4, {});
  sizes.heard(with_check(Bytes{17}, kEpoch)).heard(with_check({}, kEpoch)).heard(with_check(Bytes{0}, 0));
  sizes.parts(5, part(1, {1, 0, 1, 0, 0}) + part(8, Bytes{0} + sizes.moved(5, 1, true)));
  catalogue.session("sizes", "Datagrams of 1200 and 1201 bytes, of 6, 5 and 4.", sizes.text(), {"R-SES-1"});

  Script several;
  several.live();
  const Bytes second = several.moved(2, 1, true), third = several.moved(3, 1);
  several.parts(3, acknowledgement(1, 0, 7) + clock() + packet_part(second, 1) + packet_part(third, 0));
  several.parts(4, packet_part(several.moved(4, 1), 0) + part(100, {1, 2, 3}))
      .parts(5, packet_part(second, 4) + packet_part(second, 5));
  several.parts(6, packet_part(several.moved(6, 2), 0) + packet_part(second, 6) + packet_part(second, 7));
  catalogue.session("several", "Several packets in a datagram, of it and of those before; numbers below 1.", several.text());
}

void add_fragments(Catalogue& catalogue) {
  catalogue.section(section::kFragments);
  const auto script = [&](const char* name, const char* what, const std::function<void(Script&)>& make,
                          std::vector<std::string> rules = {}) {
    Script s(Script::objects(90));
    s.live();
    make(s);
    catalogue.session(name, what, s.text(), std::move(rules));
  };
  script("fragments", "A packet in fragments: each is acknowledged, the last as the packet is decoded.", [](Script& s) {
    const auto pieces = cut(s.large(20, 1));
    for (std::size_t i = 0; i < pieces.size(); ++i) s.parts(20 + i, fragment(i, i, pieces.size(), pieces[i]));
  });
  script("fragments-in-any-order", "Fragments of two packets, mixed, backwards, one twice.", [](Script& s) {
    const auto a = cut(s.large(20, 2)), b = cut(s.large(30, 3));
    for (std::size_t i = a.size(); i-- > 0;)
      s.parts(20 + i, fragment(i, i, a.size(), a[i])).parts(30 + i, fragment(i, i, b.size(), b[i]));
    s.parts(40, fragment(10, 0, b.size(), b[0]));
  });
  script("fragments-of-five", "Five packets at a time: the oldest gives way, and nothing of it is kept any more.", [](Script& s) {
    std::vector<std::vector<Bytes>> all;
    for (std::uint64_t n = 0; n < 5; ++n) all.push_back(cut(s.large(20 + 10 * n, n)));
    for (std::uint64_t n = 0; n < 5; ++n) s.parts(20 + 10 * n, fragment(0, 0, all[n].size(), all[n][0]));
    for (std::uint64_t n = 0; n < 5; ++n)
      for (std::size_t i = 1; i < all[n].size(); ++i) s.parts(20 + 10 * n + i, fragment(i, i, all[n].size(), all[n][i]));
  });
  script("fragments-that-do-not-fit", "Counts, indices and sizes that no packet has, and two counts for one packet.",
         [](Script& s) {
           const auto pieces = cut(s.large(20, 5));
           const std::size_t count = pieces.size();
           s.parts(20, fragment(0, 0, 1, pieces[0]))
               .parts(21, fragment(1, 0, 1025, pieces[0]))
               .parts(22, fragment(2, count, count, pieces[1]));
           s.parts(23, fragment(23, 0, count, pieces[0])).parts(24, fragment(4, 0, count, without_last(pieces[0], 1)));
           s.parts(25, fragment(5, count - 1, count, {})).parts(26, fragment(6, count - 1, count, pieces[0] + Bytes{1}));
           s.parts(27, fragment(7, 0, count, pieces[0])).parts(28, fragment(8, 1, count + 1, pieces[0]));
           for (std::size_t i = 1; i < count; ++i) s.parts(29 + i, fragment(9 + i, i, count, pieces[i]));
         },
         {"R-SES-7"});
  script("fragments-at-limits", "The last index, an empty last fragment, one of a byte, and the first number.",
         [](Script& s) {
           const auto pieces = cut(s.large(20, 7));
           s.parts(20, fragment(0, 1, 2, {})).parts(21, fragment(0, 1, 2, {1})).parts(22, fragment(21, 0, 2, pieces[0]));
           s.parts(23, fragment(22, 0, 2, pieces[0])).parts(24, fragment(24, 0, 2, pieces[0]));
           s.parts(26, fragment(0, 0, 2, pieces[0], 1)).parts(27, fragment(0, 2, 2, {1})).parts(28, fragment(0, 0, 0, pieces[0]));
         },
         {"R-SES-7"});
  script("fragments-and-others", "A fragment beside a packet or another fragment, and before a part of a later version.",
         [](Script& s) {
           const auto pieces = cut(s.large(20, 6));
           s.parts(20, fragment(0, 0, pieces.size(), pieces[0]) + packet_part({1, 2}, 0));
           s.parts(21, fragment(1, 0, pieces.size(), Bytes(300, 1)) + fragment(1, 1, pieces.size(), Bytes(300, 1)));
           for (std::size_t i = 0; i < pieces.size(); ++i)
             s.parts(22 + i, clock() + fragment(2 + i, i, pieces.size(), pieces[i]) + part(64, {9}));
         },
         {"R-SES-5"});
  script("fragments-of-nothing",
         "A whole packet in fragments that no decoder takes: what completes it is not acknowledged, nor what comes again.",
         [](Script& s) {
           const Bytes first(kFragmentSize, 0xff), last(9, 0xff);
           s.parts(20, fragment(0, 0, 2, first)).parts(21, fragment(1, 1, 2, last));
           s.parts(22, fragment(2, 1, 2, last)).parts(23, fragment(3, 0, 2, first)).packet(24, s.moved(24, 1, true));
         });
  script(
      "fragments-again", "Fragments that come again, before their packet is whole and after; one with other bytes.",
      [](Script& s) {
        const auto pieces = cut(s.large(20, 8));
        s.parts(20, fragment(0, 0, pieces.size(), pieces[0])).parts(22, fragment(2, 0, pieces.size(), Bytes(kFragmentSize, 1)));
        for (std::size_t i = pieces.size(); i-- > 0;) s.parts(40 - i, fragment(20 - i, i, pieces.size(), pieces[i]));
        for (std::size_t i = 0; i < pieces.size(); ++i) s.parts(41 + i, fragment(21 + i, i, pieces.size(), pieces[i]));
      });
  script("fragments-of-one-number",
         "Packets of one number: that of the lowest substream gives way, and an older one has no place.", [](Script& s) {
           const Bytes first(kFragmentSize, 0xff);
           for (std::uint64_t i = 0; i < 5; ++i) s.parts(20 + i, fragment(i, 0, 2, first, i));
           s.parts(25, fragment(5, 0, 2, first, 0)).parts(26, fragment(6, 0, 2, first, 1)).parts(27, fragment(8, 0, 2, first, 9));
         });
}

void add_pieces(Catalogue& catalogue) {
  catalogue.section(section::kPieces);
  Script order(Script::objects(450));
  order.welcome();
  std::uint64_t number = 0;
  for (const std::size_t i : {1u, 0u, 0u, 3u, 2u}) order.parts(++number, order.piece(i));
  for (std::size_t i = order.pieces(); i-- > 4;) order.parts(++number, order.piece(i));
  catalogue.session("pieces", "Pieces in any order, some twice.", order.text(), {"R-SES-8"});

  Script wrong(Script::objects(2500));
  wrong.welcome();
  const Bytes piece(kPieceSize, 7);
  wrong.parts(1, part(4, varint(64) + piece))
      .parts(2, part(4, varint(63) + piece))
      .parts(3, part(4, varint(wrong.pieces()) + piece));
  wrong.parts(4, part(4, varint(0) + without_last(piece, 1)))
      .parts(5, part(4, varint(0) + piece + Bytes{1}))
      .parts(6, part(4, varint(0)));
  wrong.packet(7, wrong.moved(7, 1, true)).parts(8, wrong.piece(0)).parts(9, part(4, varint(64) + piece));
  catalogue.session("pieces-that-are-none",
                    "Beyond the window, beyond the declaration, of other sizes; and a packet before the scene.", wrong.text(),
                    {"R-SES-8"});

  Script damaged;
  damaged.heard(damaged.welcome_for(0, kEpoch, kNonce, damaged.declaration().size(), 12345)).parts(1, damaged.piece(0));
  catalogue.session("another-hash", "A declaration with another hash than was announced: the client leaves.", damaged.text(),
                    {"R-SES-10"});

  Script unreadable;
  const Bytes noise(100, 0x55);
  unreadable.heard(unreadable.welcome_for(0, kEpoch, kNonce, noise.size(), hash_of(noise)));
  unreadable.parts(1, part(4, varint(0) + noise));
  catalogue.session("no-declaration", "What was announced is no declaration: the client leaves.", unreadable.text());

  Script huge;
  huge.heard(huge.welcome_for(0, kEpoch, kNonce, (1u << 20) + 1, 1));
  Script grown;
  grown.live().heard(grown.welcome_for(1, kEpoch + 9, kNonce, (1u << 20) + 1, 1));
  catalogue.session("too-large", "A declaration beyond the client's limit: it does not stay.", huge.text());
  catalogue.session("grows-too-large", "Another scene beyond the client's limit: it leaves in the new epoch.", grown.text());

  Script after;
  after.live().parts(2, after.piece(0)).parts(3, part(4, varint(9) + Bytes(1024, 1))).packet(4, after.moved(4, 1, true));
  catalogue.session("pieces-later", "Pieces that come when the client is live.", after.text());
}

}  // namespace

void add_session(Catalogue& catalogue) {
  add_joining(catalogue);
  add_parts(catalogue);
  add_numbers(catalogue);
  add_fragments(catalogue);
  add_pieces(catalogue);
}

}  // namespace tactus::conformance
