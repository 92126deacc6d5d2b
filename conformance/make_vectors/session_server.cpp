// SPDX-License-Identifier: Apache-2.0
/// What a server does with the datagrams of clients, made field by field.
#include <functional>
#include <string>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"
#include "conformance/make_vectors/session_build.h"

namespace tactus::conformance {
namespace {

constexpr std::uint64_t kEntropy = 0x0123456789abcdef;

/// SplitMix64: the epoch that the server draws as its n-th, from 0.
std::uint64_t drawn(std::uint64_t n) {
  std::uint64_t z = kEntropy + (n + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

/// A join, after a change to its bytes.
struct JoinSaid {
  std::uint8_t role = 1, version = 1;
  std::uint64_t nonce = kNonce, state_limit = 1u << 28, header_limit = 1u << 20;
  std::size_t size = 80;
  std::string magic = "TCTS";

  Bytes datagram() const {
    Bytes body = head(0, 0) + Bytes(magic.begin(), magic.end()) + Bytes{version, role} + little(nonce);
    body = body + varint(state_limit) + varint(header_limit);
    body.resize(size - 4);
    return with_check(body, 0, 0);
  }
};

Bytes state(std::uint8_t live) { return part(5, {live}); }
Bytes buttons(std::uint32_t tick, std::uint32_t mask) { return part(3, little(tick) + little(mask)); }

RawHeader scene_of(std::size_t objects) {
  RawHeader header{.objects = {}};
  for (std::size_t i = 0; i < objects; ++i) header.objects.push_back({.name = "object " + std::to_string(i)});
  header.baseline_span = 64;
  return header;
}
/// Of the devices of its participants (65, section 2).
RawHeader device_of(const RawHeader& scene) {
  RawHeader header = scene;
  header.objects = {{.name = "device"}};
  header.max_extrapolation = 100;
  return header;
}

/// Lines for a server, and clients that make them. A client is known by its address.
class ServerScript {
 public:
  explicit ServerScript(const RawHeader& scene = scene_of(1), unsigned clients = 2) : device_(device_of(scene)) {
    line("\"serve\":\"" + hex(scene.bytes()) + "\",\"entropy\":\"" + hex(little(kEntropy), true) +
         "\",\"clients\":" + std::to_string(clients));
  }
  ServerScript& pass(std::uint64_t milliseconds) {
    time_ += 1000 * milliseconds;
    return line("\"waits\":1");
  }
  /// The next line comes early.
  ServerScript& soon() {
    line("\"waits\":1");
    time_ -= 270'000;
    return *this;
  }
  ServerScript& heard(unsigned from, const Bytes& datagram) {
    return line("\"from\":" + std::to_string(from) + ",\"heard\":\"" + hex(datagram) + '"');
  }
  ServerScript& parts(unsigned from, std::uint64_t number, const Bytes& all, std::uint64_t epoch = drawn(0)) {
    return heard(from, with_check(head(1, number) + all, epoch, 0));
  }
  ServerScript& packet(unsigned from, std::uint64_t number, const Bytes& packet, std::uint64_t epoch = drawn(0)) {
    return heard(from, with_check(head(2, number) + packet, epoch, 0));
  }
  /// All that the server has said, and other parts.
  ServerScript& acknowledges(unsigned from, std::uint64_t number, const Bytes& parts = {}, std::uint64_t epoch = drawn(0)) {
    return line("\"from\":" + std::to_string(from) + ",\"acknowledges\":" + std::to_string(number) + ",\"epoch\":\"" +
                hex(little(epoch), true) + "\",\"parts\":\"" + hex(parts) + '"');
  }
  ServerScript& replace(const RawHeader& scene) {
    device_ = Stream(device_of(scene));
    return line("\"scene\":\"" + hex(scene.bytes()) + '"');
  }
  ServerScript& closes(unsigned client, unsigned reason) {
    return line("\"closes\":" + std::to_string(client) + ",\"reason\":" + std::to_string(reason));
  }
  /// Join to live, with numbers 1 and 2.
  ServerScript& live(unsigned from = 1, const JoinSaid& join = {}, std::uint64_t epoch = drawn(0)) {
    return heard(from, join.datagram()).parts(from, 1, state(0), epoch).acknowledges(from, 2, state(1), epoch);
  }
  ServerScript& leave(unsigned from, std::uint8_t reason, std::uint64_t epoch = drawn(0)) {
    return heard(from, with_check(head(0, 3) + Bytes{reason}, epoch, 0));
  }
  /// The packet of the device of this number.
  Bytes device(std::uint64_t number, std::uint32_t baseline = 1, bool key = false) {
    const auto n = static_cast<std::int32_t>(number);
    const Bytes packet =
        device_.packet({.tick = static_cast<std::int64_t>(10 * number),
                        .updates = {{0, Reason::visual, 0, {{{100 * n, -7 * n, n}, {n, 0, 3}, {5 * n, 1, 0}, {}}}}},
                        .key = key,
                        .baseline = baseline,
                        .sequence = static_cast<std::uint16_t>(number)});
    return Bytes(packet.begin() + 2, packet.end());  // the session knows its number
  }
  Input text() const { return Bytes(text_.begin(), text_.end()); }

 private:
  ServerScript& line(const std::string& said) {
    text_ += "{\"at\":" + std::to_string(time_) + ',' + said + "}\n";
    time_ += 300'017;  // what goes each 250 ms goes once after a line
    return *this;
  }

  Stream device_;
  std::string text_;
  std::uint64_t time_ = 5'000'000;
};

/// Adds a script to the catalogue.
class Adder {
 public:
  explicit Adder(Catalogue& catalogue) : catalogue_(catalogue) {}
  void operator()(const char* name, const char* what, const std::function<void(ServerScript&)>& make,
                  std::vector<std::string> rules = {}, ServerScript script = ServerScript()) const {
    make(script);
    catalogue_.session(std::string("server-") + name, what, script.text(), std::move(rules));
  }

 private:
  Catalogue& catalogue_;
};

void add_joins(Catalogue& catalogue) {
  catalogue.section(section::kJoining);
  const Adder add(catalogue);
  add("join", "A participant joins, gets the declaration and is live.", [](ServerScript& s) { s.live(); });
  add("observer", "An observer joins; its packets are refused, what else it says is not.", [](ServerScript& s) {
    s.live(1, {.role = 0}).packet(1, 3, s.device(3, 1, true)).parts(1, 4, part(64, {1}) + packet_part(s.device(4, 1, true), 1));
    s.parts(1, 5, state(1));
  });
  add("joins-again", "The same join twice, also when live, then one with another nonce: the session before ends.",
      [](ServerScript& s) {
        s.heard(1, JoinSaid{}.datagram()).heard(1, JoinSaid{}.datagram()).parts(1, 1, state(0));
        s.acknowledges(1, 2, state(1)).heard(1, JoinSaid{}.datagram()).parts(1, 3, state(1));
        s.heard(1, JoinSaid{.role = 0, .nonce = 5}.datagram()).parts(1, 4, state(1)).parts(1, 1, state(0), drawn(1));
      });
  add("full", "More clients than there is room for; one leaves, and its place is taken.", [](ServerScript& s) {
    s.live(7).heard(8, JoinSaid{.role = 0, .nonce = 8}.datagram()).heard(9, JoinSaid{.nonce = 9}.datagram());
    s.leave(7, 0).heard(9, JoinSaid{.nonce = 9}.datagram()).parts(9, 1, state(0), drawn(2));
  });
  add("limits", "Limits that the scene just keeps, and by one byte less each.", [](ServerScript& s) {
    const std::uint64_t header = scene_of(1).bytes().size();
    s.heard(1, JoinSaid{.header_limit = header - 1}.datagram()).heard(1, JoinSaid{.header_limit = header}.datagram());
    s.heard(2, JoinSaid{.state_limit = 1}.datagram()).heard(2, JoinSaid{.state_limit = 0}.datagram());
  });
  add("versions", "Joins of other versions, whatever they hold, are told so; shorter ones than an answer are not.",
      [](ServerScript& s) {
        s.heard(1, JoinSaid{.role = 200, .version = 2}.datagram()).heard(1, JoinSaid{.version = 0, .size = 1200}.datagram());
        s.heard(1, JoinSaid{.version = 2, .size = 79}.datagram()).live().heard(1, JoinSaid{.version = 255}.datagram());
      },
      {"R-SES-3"});
  add("no-joins", "Joins with other magic bytes or roles.",
      [](ServerScript& s) {
        s.heard(1, JoinSaid{.magic = "TCTR"}.datagram()).heard(1, JoinSaid{.role = 2}.datagram());
        s.heard(1, JoinSaid{.version = 9, .magic = "\x89TCT"}.datagram()).heard(1, JoinSaid{}.datagram());
      },
      {"R-SES-9"});
  add("joins-cut", "Joins that are too short, have something behind them, or varints that are not the shortest.",
      [](ServerScript& s) {
        for (const std::size_t size : {79u, 30u, 20u, 8u, 6u}) s.heard(1, JoinSaid{.size = size}.datagram());
        Bytes body = head(0, 0) + Bytes{'T', 'C', 'T', 'S', 1, 1} + little(kNonce) + varint(1u << 28) + varint(1u << 20);
        Bytes spare = body, wide = body;
        spare.resize(76);
        spare.back() = 1;
        s.heard(1, with_check(spare, 0, 0));
        wide.back() |= 0x80;
        wide.resize(76);
        s.heard(1, with_check(wide, 0, 0)).heard(1, JoinSaid{.size = 1200}.datagram());
      },
      {"R-SES-3"});
}

void add_leaves(Catalogue& catalogue) {
  catalogue.section(section::kJoining);
  const Adder add(catalogue);
  add("strangers", "Datagrams of addresses that have not joined, of other epochs and directions, of none.",
      [](ServerScript& s) {
        s.parts(1, 1, state(0)).heard(1, JoinSaid{}.datagram()).parts(2, 1, state(0)).parts(1, 1, state(0), drawn(0) + 1);
        s.heard(1, with_check(head(1, 1) + state(0), drawn(0), 1)).heard(1, {}).heard(1, Bytes(5, 0)).heard(1, Bytes(6, 0));
        s.heard(1, with_check(head(1, 1) + state(0) + part(64, Bytes(1189, 1)), drawn(0), 0));
        s.heard(1, with_check(head(1, 1) + state(0) + part(64, Bytes(1188, 1)), drawn(0), 0)).leave(2, 0).leave(1, 0, 0);
      },
      {"R-SES-1"});
  add("forms-and-kinds", "Handshakes that do not come up, unknown ones, and form 3.",
      [](ServerScript& s) {
        s.live();
        for (const unsigned kind : {1u, 2u}) s.heard(1, with_check(head(0, kind) + Bytes(30, 0), 0, 0));
        s.heard(3, with_check(head(0, 1) + Bytes(30, 0), 0, 0));
        s.heard(1, with_check(head(0, 4) + Bytes{0}, drawn(0), 0)).heard(1, with_check(head(0, 0) + Bytes{0}, drawn(0), 0));
        s.heard(1, with_check(head(3, 3) + Bytes{0}, drawn(0), 0)).parts(1, 3, state(1));
      },
      {"R-SES-2"});
  add("leaves", "Leaves with every reason, one that is unknown, one that is cut and one that goes on.",
      [](ServerScript& s) {
        s.live().leave(1, 7).heard(1, with_check(head(0, 3), drawn(0), 0));
        s.heard(1, with_check(head(0, 3) + Bytes{0, 0}, drawn(0), 0)).leave(1, 6).leave(1, 6);
        for (std::uint8_t reason = 0; reason < 6; ++reason) {
          const std::uint64_t epoch = drawn(1u + reason);
          s.heard(1, JoinSaid{.nonce = reason}.datagram()).parts(1, 1, state(0), epoch).leave(1, reason, epoch);
        }
      },
      {"R-SES-3"});
  add("lets-go", "The program lets clients go: one that is live, and one of which nothing was heard.", [](ServerScript& s) {
    s.live(1).heard(2, JoinSaid{.nonce = 2}.datagram()).closes(0, 6).closes(1, 0).parts(1, 3, state(1));
  });
  add("silence", "A client that never speaks is forgotten after 10 s; one that falls silent is told after 120 s.",
      [](ServerScript& s) {
        s.heard(2, JoinSaid{.nonce = 2}.datagram()).live(1, {}, drawn(1)).pass(10'000).pass(105'000).pass(10'000);
      });
}

void add_parts(Catalogue& catalogue) {
  catalogue.section(section::kDatagram);
  const Adder add(catalogue);
  add("parts", "Parts that come up, in order, out of order, and those that do not.",
      [](ServerScript& s) {
        s.live().parts(1, 3, buttons(5, 1) + state(1) + part(6, Bytes(7, 1)) + packet_part(s.device(3, 1, true), 0));
        s.parts(1, 4, state(1) + buttons(6, 2)).parts(1, 5, clock()).parts(1, 6, part(4, {0, 1})).parts(1, 7, part(9, {}));
        s.parts(1, 8, {}).parts(1, 9, packet_part(s.device(9, 1, true), 0)).parts(1, 10, part(64, {}) + state(1));
        s.parts(1, 11, state(1) + state(1) + part(255, {7}));
      },
      {"R-SES-5"});
  add("parts-cut", "Parts that end early or have bytes too many, and a state that is neither 0 nor 1.",
      [](ServerScript& s) {
        s.live().parts(1, 3, part(5, {})).parts(1, 4, part(5, {1, 0})).parts(1, 5, state(2)).parts(1, 6, part(3, Bytes(7, 0)));
        s.parts(1, 7, part(3, Bytes(9, 0))).parts(1, 8, part(6, Bytes(6, 0))).parts(1, 9, part(6, Bytes(8, 0)));
        s.parts(1, 10, Bytes{5}).parts(1, 11, Bytes{5, 2, 1}).parts(1, 12, part(8, {0x80, 0})).parts(1, 3, state(1));
      },
      {"R-SES-3"});
}

void add_numbers(Catalogue& catalogue) {
  catalogue.section(section::kAcknowledgements);
  const Adder add(catalogue);
  add("device", "Packets of a device one after the other, then one that builds on what was never sent, and a key packet.",
      [](ServerScript& s) {
        s.live().packet(1, 3, s.device(3, 1, true));
        for (std::uint64_t n = 4; n < 8; ++n) s.packet(1, n, s.device(n));
        s.packet(1, 20, s.device(20, 12)).packet(1, 21, s.device(21, 14)).packet(1, 22, s.device(22, 1, true));
        s.packet(1, 23, Bytes{0xff, 0xff, 0xff}).packet(1, 24, s.device(24, 2));
      });
  add("device-early", "Packets of a device before the client is live.", [](ServerScript& s) {
    const Bytes packet = s.device(2, 1, true);
    s.heard(1, JoinSaid{}.datagram()).parts(1, 1, state(0)).packet(1, 2, packet).acknowledges(1, 3, state(1));
    s.parts(1, 4, packet_part(packet, 2));
  });
  add("overtaken", "Packets of a device overtake each other and come again.", [](ServerScript& s) {
    s.live().packet(1, 3, s.device(3, 1, true));
    const Bytes fourth = s.device(4, 1), fifth = s.device(5, 2);
    s.packet(1, 5, fifth).packet(1, 4, fourth).packet(1, 4, fourth).parts(1, 6, packet_part(fourth, 2) + packet_part(fifth, 1));
  });
  add("gaps", "Missing numbers, 64 back and more, some that come later, some twice.",
      [](ServerScript& s) {
        s.live();
        for (const std::uint64_t n : {3u, 5u, 8u, 6u, 8u, 5u, 80u, 79u, 15u, 144u, 1200u, 176u, 177u}) s.parts(1, n, state(1));
      },
      {"R-SES-4"});
  add("buttons", "Buttons of a device: newer ones hold, older ones do not.", [](ServerScript& s) {
    s.live().parts(1, 3, buttons(30, 1) + packet_part(s.device(3, 1, true), 0)).parts(1, 4, buttons(50, 6));
    s.parts(1, 5, buttons(40, 9)).parts(1, 6, buttons(50, 7)).parts(1, 7, buttons(0xffffffff, 0x80000000));
  });
  add("never-sent", "Acknowledgements of numbers that the server has not used; what follows them has no effect.",
      [](ServerScript& s) {
        s.heard(1, JoinSaid{}.datagram()).acknowledges(1, 1, state(1)).parts(1, 2, state(0)).parts(1, 3, acknowledgement(500, 0));
        s.parts(1, 4, acknowledgement(0, 0) + state(1)).acknowledges(1, 5, state(1)).parts(1, 6, acknowledgement(9999, 0));
      },
      {"R-SES-6"});
  add("quiet", "Acknowledgements ask for nothing; other parts do.", [](ServerScript& s) {
    s.live().acknowledges(1, 3).acknowledges(1, 4, part(64, {1})).parts(1, 5, part(70, {})).parts(1, 6, buttons(1, 1));
  });
  add("hashes", "Hashes of states that the server does not know say nothing.", [](ServerScript& s) {
    s.live()
        .parts(1, 3, part(6, Bytes{0} + little(std::uint16_t{64}) + little(std::uint32_t{7})))
        .parts(1, 4, part(6, Bytes(7, 255)));
  });
  add("two-rules", "Datagrams that break two rules: syntax first, then the number, then what the parts say.",
      [](ServerScript& s) {
        s.live().parts(1, 2, Bytes{5}).parts(1, 2, part(9, {})).parts(1, 2, acknowledgement(500, 0));
        s.parts(1, 3, acknowledgement(500, 0) + Bytes{8, 9})
            .parts(1, 4, acknowledgement(500, 0) + state(1))
            .parts(1, 3, state(1));
      },
      {"R-SES-3", "R-SES-4", "R-SES-5", "R-SES-6"});
}

void add_fragments(Catalogue& catalogue) {
  catalogue.section(section::kFragments);
  const Adder add(catalogue);
  add("fragments", "Fragments that do not fit.",
      [](ServerScript& s) {
        const Bytes whole(kFragmentSize, 1);
        s.live()
            .parts(1, 3, fragment(0, 0, 1, whole))
            .parts(1, 4, fragment(0, 2, 2, whole))
            .parts(1, 5, fragment(5, 0, 2, whole));
        s.parts(1, 6, fragment(0, 0, 2, {1})).parts(1, 7, fragment(0, 0, 2, whole) + state(1)).parts(1, 8, fragment(0, 1, 2, {}));
        s.parts(1, 9, state(1));
      },
      {"R-SES-5", "R-SES-7"});
}

void add_epochs(Catalogue& catalogue) {
  catalogue.section(section::kPieces);
  const Adder add(catalogue);
  add(
      "pieces", "A declaration of several pieces: live is who has acknowledged all.",
      [](ServerScript& s) {
        s.heard(1, JoinSaid{}.datagram()).parts(1, 1, state(1));
        for (int i = 0; i < 8; ++i) s.soon();
        s.parts(1, 2, state(1)).acknowledges(1, 3, state(0)).parts(1, 4, state(0)).parts(1, 5, state(1)).parts(1, 6, state(0));
      },
      {}, ServerScript(scene_of(90)));
  add("another-scene", "Another scene: a welcome until something of its epoch comes; what is of the old one says nothing.",
      [](ServerScript& s) {
        s.live().packet(1, 3, s.device(3, 1, true)).heard(2, JoinSaid{.nonce = 2}.datagram());
        const Bytes late = s.device(4);
        s.replace(scene_of(2)).packet(1, 4, late).pass(100).parts(1, 1, state(0), drawn(2)).pass(100);
        s.acknowledges(1, 2, state(1), drawn(2)).packet(1, 3, s.device(3, 1, true), drawn(2)).parts(2, 1, state(0), drawn(1));
        s.pass(100).parts(2, 1, state(0), drawn(3));
      },
      {"R-SES-1"});
  add("scene-beyond-limits", "Another scene, beyond the limits of one of two clients.", [](ServerScript& s) {
    s.live(1, {.header_limit = scene_of(2).bytes().size()})
        .live(2, {.nonce = 2, .header_limit = scene_of(1).bytes().size()}, drawn(1));
    s.replace(scene_of(2)).parts(2, 3, state(1), drawn(1)).parts(1, 1, state(0), drawn(2));
  });
  add("scenes", "Two other scenes, one after the other, before the client has said anything.", [](ServerScript& s) {
    s.live().replace(scene_of(2)).replace(scene_of(3)).parts(1, 1, state(0), drawn(1)).parts(1, 1, state(0), drawn(2));
    s.acknowledges(1, 2, state(1), drawn(2)).heard(1, JoinSaid{}.datagram());
  });
}

}  // namespace

void add_session_server(Catalogue& catalogue) {
  add_joins(catalogue);
  add_leaves(catalogue);
  add_parts(catalogue);
  add_numbers(catalogue);
  add_fragments(catalogue);
  add_epochs(catalogue);
}

}  // namespace tactus::conformance
