// SPDX-License-Identifier: Apache-2.0
/// Users of a server: the file that lists them, their roles, and what becomes of those who are removed while it runs.
#include <tactus/seal/key_list.h>

#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "tests/unit/seal_fixture.h"

namespace tactus::seal {
namespace {

using tactus::testing::Bytes;
using tactus::testing::bytes_of;
using tactus::testing::key_of;
using tactus::testing::SealPair;

const std::string kHead = "tactus keys 1\n";
std::string line(const std::string& name, const std::string& role, char digit = 'a') {
  return name + ' ' + role + ' ' + std::string(64, digit) + '\n';
}

/// Names and roles, in their order.
std::string users_of(const KeyList& list) {
  std::string out;
  for (const KeyList::User& user : list.users()) out += std::string(user.name()) + ':' + name_of(user.role) + ' ';
  return out;
}

KeyList list_of(const std::string& lines) { return KeyList::parse(kHead + lines, "test").value(); }

class SealKeyList : public ::testing::Test {
 protected:
  SealKeyList() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tactus-keys-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~SealKeyList() override { std::filesystem::remove_all(folder_); }
  std::string path() const { return folder_ + "/lab.keys"; }
  std::string written(const std::string& text, mode_t mode = 0600) const {
    std::ofstream(path()) << text;
    chmod(path().c_str(), mode);
    return path();
  }
  std::size_t files() const { return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {})); }

 private:
  std::string folder_;
};

TEST_F(SealKeyList, IsWrittenAndReadBack) {
  const mode_t before = umask(0);
  KeyList list;
  ASSERT_TRUE(list.add(Key::generate("anna").value(), Role::touch));
  ASSERT_TRUE(list.add(Key::generate("room-2.b_C").value(), Role::observe));
  ASSERT_TRUE(list.write(path()));
  umask(before);
  struct stat status {};
  ASSERT_EQ(stat(path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777u, 0600u);
  const auto back = KeyList::read(path());
  ASSERT_TRUE(back) << to_string(back.error());
  EXPECT_EQ(users_of(*back), "anna:touch room-2.b_C:observe ");
  for (const KeyList::User& user : list.users()) EXPECT_TRUE(back->holds(*user.key));
  EXPECT_FALSE(back->holds(Key::generate("anna").value())) << "another secret";
  EXPECT_EQ(back->find("nobody"), nullptr);

  ASSERT_TRUE(list.remove("anna"));
  EXPECT_FALSE(list.remove("anna"));
  ASSERT_TRUE(list.write(path()));
  EXPECT_EQ(users_of(KeyList::read(path()).value()), "room-2.b_C:observe ");
  EXPECT_EQ(files(), 1u) << "nothing beside it stays";
  std::filesystem::create_directory(path() + ".d");
  EXPECT_FALSE(list.write(path() + ".d"));
  EXPECT_EQ(files(), 2u);
}

TEST_F(SealKeyList, AKeyFileIsAListOfOne) {
  ASSERT_TRUE(Key::generate("lab")->write(path()));
  EXPECT_EQ(users_of(KeyList::read(path()).value()), "lab:touch ");
  const auto refused = Key::read(written(kHead + line("anna", "touch")));
  ASSERT_FALSE(refused) << "but a list is no key file";
  EXPECT_STREQ(refused.error().error.rule, "R-KEY-7");
}

TEST_F(SealKeyList, OthersMayNeitherReadNorWriteIt) {
  for (const mode_t mode : {0640u, 0604u, 0620u, 0602u, 0777u})
    EXPECT_STREQ(KeyList::read(written(kHead, mode)).error().error.rule, "R-KEY-2") << std::oct << mode;
  EXPECT_TRUE(KeyList::read(written(kHead, 0600))) << "nobody may be in it";
  EXPECT_STREQ(KeyList::read(path() + ".nowhere").error().error.rule, "R-KEY-1");
}

TEST_F(SealKeyList, ItsTextHasOneFormOnly) {
  struct Wrong {
    std::string text;
    std::uint64_t line;
    const char* rule;
  };
  std::string many = kHead;
  for (std::size_t i = 0; i < KeyList::kMostUsers; ++i)
    many += line(std::string(58, 'n') + std::to_string(100'000 + i), "observe");
  const std::string secret(64, 'a');
  const Wrong wrongs[]{
      {"", 1, "R-KEY-3"},
      {"tactus keys 2\n", 1, "R-KEY-3"},
      {"tactus keys 1", 1, "R-KEY-3"},
      {"tactus keys 1\r\n", 1, "R-KEY-3"},
      {kHead + "\n", 2, "R-KEY-5"},
      {kHead + "# anna\n", 2, "R-KEY-5"},
      {kHead + line("anna", "feel"), 2, "R-KEY-5"},
      {kHead + line("anna", "Touch"), 2, "R-KEY-5"},
      {kHead + line("", "touch"), 2, "R-KEY-5"},
      {kHead + line("a/b", "touch"), 2, "R-KEY-5"},
      {kHead + line(std::string(65, 'n'), "touch"), 2, "R-KEY-5"},
      {kHead + line("anna", "touch "), 2, "R-KEY-5"},
      {kHead + "anna  touch " + secret + "\n", 2, "R-KEY-5"},
      {kHead + "anna touch " + secret + " \n", 2, "R-KEY-5"},
      {kHead + "anna touch " + secret + "\r\n", 2, "R-KEY-5"},
      {kHead + "anna touch " + secret, 2, "R-KEY-5"},
      {kHead + "anna touch " + secret.substr(1) + "\n", 2, "R-KEY-5"},
      {kHead + line("anna", "touch", 'A'), 2, "R-KEY-5"},
      {kHead + line("anna", "touch") + line("ben", "touch", 'g'), 3, "R-KEY-5"},
      {kHead + line("anna", "touch") + line("ben", "observe") + line("anna", "observe", 'b'), 4, "R-KEY-6"},
      {many + line("one-more", "touch"), KeyList::kMostUsers + 2, "R-KEY-6"},
      {many + std::string(1'000'000, 'x'), KeyList::kMostUsers + 2, "R-KEY-5"},
  };
  EXPECT_EQ(KeyList::read(written(many)).value().users().size(), KeyList::kMostUsers);
  for (const auto& [text, line, rule] : wrongs) {
    const auto read = KeyList::read(written(text));
    ASSERT_FALSE(read) << text.substr(0, 100);
    EXPECT_STREQ(read.error().error.rule, rule) << text.substr(0, 100);
    EXPECT_EQ(read.error().line, line) << text.substr(0, 100);
    EXPECT_EQ(to_string(read.error()).find("aaaa"), std::string::npos) << "a message never holds a secret";
  }
}

TEST_F(SealKeyList, DamageYieldsAnErrorOrNamesThatAreNames) {
  const std::string good = kHead + line("anna", "touch") + line("ben", "observe", 'b');
  for (std::size_t size = 0; size < good.size(); ++size) {
    const auto read = KeyList::parse(good.substr(0, size), "f");
    EXPECT_EQ(read.has_value(), size == kHead.size() || size == kHead.size() + line("anna", "touch").size()) << size;
  }
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string changed = good;
    changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ (1 << bit % 8));
    const auto read = KeyList::parse(changed, "f");
    if (!read) continue;
    EXPECT_EQ(read->users().size(), 2u);
    for (const KeyList::User& user : read->users()) EXPECT_TRUE(Key::is_name(user.name()));
  }
}

TEST_F(SealKeyList, HasEachNameOnceAndNoMoreThan1024) {
  KeyList list = list_of(line("anna", "touch"));
  const auto twice = list.add(Key::generate("anna").value(), Role::touch);
  ASSERT_FALSE(twice);
  EXPECT_STREQ(twice.error().rule, "R-KEY-6");
  while (list.users().size() < KeyList::kMostUsers)
    ASSERT_TRUE(list.add(Key::generate("u" + std::to_string(list.users().size())).value(), Role::observe));
  const auto more = list.add(Key::generate("more").value(), Role::touch);
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, Errc::limit_exceeded);
  EXPECT_EQ(list.users().size(), KeyList::kMostUsers);
}

/// Another file, or this one changed, is read; a broken one is reported once.
TEST_F(SealKeyList, AFileThatChangesIsReadAgain) {
  const auto age = [this] {  // as if it had been written some time ago
    std::filesystem::last_write_time(path(), std::filesystem::file_time_type::clock::now() - std::chrono::seconds(1));
  };
  EXPECT_FALSE(KeyListFile::open(path()));
  written(kHead + line("anna", "touch"));
  auto file = KeyListFile::open(path()).value();
  EXPECT_EQ(file.read_again(), false);
  written(kHead + line("anna", "touch") + line("ben", "touch"));
  EXPECT_EQ(file.look(), false) << "just now: it may be half of a file";
  EXPECT_EQ(users_of(file.keys()), "anna:touch ");
  age();
  EXPECT_EQ(file.look(), true);
  EXPECT_EQ(users_of(file.keys()), "anna:touch ben:touch ");
  EXPECT_EQ(file.look(), false);

  for (const std::string& wrong : {kHead + "junk\n", std::string()}) {
    written(wrong);
    const auto refused = file.read_again();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().file, path());
    EXPECT_EQ(file.read_again(), false) << "reported once";
  }
  chmod(written(kHead).c_str(), 0644);
  EXPECT_STREQ(file.read_again().error().error.rule, "R-KEY-2");
  std::filesystem::remove(path());
  EXPECT_STREQ(file.read_again().error().error.rule, "R-KEY-1");
  EXPECT_EQ(file.read_again(), false);
  EXPECT_EQ(users_of(file.keys()), "anna:touch ben:touch ") << "whatever becomes of the file";
  ASSERT_TRUE(list_of(line("carl", "observe")).write(path()));
  EXPECT_EQ(file.read_again(), true);
  EXPECT_EQ(users_of(file.keys()), "carl:observe ");
}

// ==== users of a server ====

/// Anna may touch, ben look on.
KeyList lab(const std::string& anna = "a", const std::string& ben = "b") {
  return list_of(line("anna", "touch", anna[0]) + line("ben", "observe", ben[0]));
}

struct LabPair : SealPair {
  explicit LabPair(Key key) : SealPair(std::move(key)) {
    server = Server::create(lab(), now).value();
    run();
    if (client.is_open()) say_up("x");
  }
};

TEST(SealUsers, TheServerKnowsWhoseAssociationItIs) {
  for (const auto& [name, digit, role] : {std::tuple("anna", "aa", Role::touch), std::tuple("ben", "bb", Role::observe)}) {
    LabPair pair(key_of(name, digit));
    ASSERT_TRUE(pair.client.is_open()) << name;
    const KeyList::User* const user = pair.server.user_of(pair.peer);
    ASSERT_NE(user, nullptr);
    EXPECT_EQ(user->name(), name);
    EXPECT_EQ(user->role, role);
  }
  LabPair pair(key_of("ben", "aa"));
  EXPECT_FALSE(pair.client.is_open()) << "the secret of another user";
  EXPECT_EQ(pair.error, "R-SEA-2");
  EXPECT_EQ(pair.server.user_of(1), nullptr);
}

TEST(SealUsers, WhoIsRemovedGetsAnAlertAndOthersStay) {
  LabPair anna(key_of("anna", "aa"));
  auto ben = Client::create(key_of("ben", "bb"), anna.now).value();
  const net::Address there = tactus::testing::address("192.0.2.8:4000");
  for (int i = 0; i < 8; ++i) {
    while (const auto datagram = ben.poll_datagram()) static_cast<void>(anna.server.open(anna.now, there, *datagram));
    anna.server.work(anna.now);
    while (const auto datagram = anna.server.poll_datagram()) static_cast<void>(ben.open(anna.now, datagram->bytes));
  }
  ASSERT_TRUE(ben.is_open());
  EXPECT_TRUE(anna.server.replace(lab()).empty()) << "the same users again";
  EXPECT_EQ(anna.server.peers(), 2u);
  EXPECT_EQ(anna.server.replace(list_of(line("ben", "touch", 'b') + line("carl", "touch"))), std::vector{anna.peer});
  EXPECT_EQ(anna.server.user_of(anna.peer), nullptr);
  EXPECT_FALSE(anna.say_up("still there?") && anna.heard_up.size() > 1) << "what comes from there is dropped";
  EXPECT_EQ(anna.server.user_of(2)->role, Role::touch) << "another role, the same association";
  const auto sealed = ben.seal(bytes_of("hello"));
  const auto opened = anna.server.open(anna.now, there, *sealed);
  ASSERT_TRUE(opened);
  EXPECT_EQ(bytes_of(opened->plain), bytes_of("hello"));
  anna.drain();
  EXPECT_EQ(anna.error, "R-SEA-7") << "the alert is authentic";
  EXPECT_FALSE(anna.client.is_open());
  EXPECT_FALSE(anna.server.poll_closed()) << "replace() has named it";
}

TEST(SealUsers, OneOfThreeCopiesIsEnough) {
  for (int heard = 0; heard < 3; ++heard) {
    LabPair pair(key_of("anna", "aa"));
    int copy = 0;
    pair.network_down = [&](const Bytes& datagram) {
      return copy++ == heard ? std::vector<Bytes>{datagram} : std::vector<Bytes>{};
    };
    EXPECT_EQ(pair.server.replace(KeyList()).size(), 1u);
    pair.drain();
    EXPECT_EQ(copy, 3);
    EXPECT_EQ(pair.error, "R-SEA-7") << heard;
  }
}

TEST(SealUsers, AnotherKeyEndsWhatTheOldOneBegan) {
  LabPair pair(key_of("anna", "aa"));
  EXPECT_EQ(pair.server.replace(lab("c")).size(), 1u);
  pair.error.clear();
  pair.client = Client::create(key_of("anna", "cc"), pair.now).value();
  pair.run();
  EXPECT_TRUE(pair.client.is_open()) << "who has the new one can come at once";
}

/// A handshake that has begun with a user who is removed meanwhile.
TEST(SealUsers, AHandshakeOfARemovedUserDoesNotEnd) {
  SealPair pair(key_of("anna", "aa"));
  pair.server = Server::create(lab(), pair.now).value();
  bool is_cut = false;
  pair.network_down = [&](const Bytes& datagram) {  // the server's last flight does not arrive
    is_cut = is_cut || pair.server.peers() > 0;
    return is_cut ? std::vector<Bytes>{} : std::vector<Bytes>{datagram};
  };
  pair.run(100'000);
  ASSERT_FALSE(pair.client.is_open());
  ASSERT_EQ(pair.server.peers(), 1u);
  pair.server.replace(list_of(line("ben", "observe", 'b')));
  EXPECT_EQ(pair.server.peers(), 0u);
  pair.network_down = pair.network_up;
  pair.run();
  EXPECT_FALSE(pair.client.is_open());
  EXPECT_EQ(pair.error, "R-SEA-2");
}

TEST(SealUsers, WhoIsAddedWhileTryingComesIn) {
  SealPair pair(key_of("carl", "cc"));
  pair.server = Server::create(lab(), pair.now).value();
  pair.run(1'000'000);
  EXPECT_TRUE(pair.client.is_doubted());
  pair.server.replace(list_of(line("carl", "touch", 'c')));
  pair.run(5'000'000);
  EXPECT_TRUE(pair.client.is_open());
  EXPECT_FALSE(pair.client.is_doubted());
}

// ==== a wrong key ====

TEST(SealWrongKey, IsReportedAtOnceWhicheverPartOfItIsWrong) {
  std::vector<std::vector<std::size_t>> answers;
  for (const auto& [name, byte] : {std::pair("lab", "5b"), std::pair("lob", "5a"), std::pair("lob", "5b")}) {
    SealPair pair(key_of(name, byte));
    std::vector<std::size_t>& sizes = answers.emplace_back();
    pair.network_down = [&sizes](const Bytes& datagram) {
      sizes.push_back(datagram.size());
      return std::vector<Bytes>{datagram};
    };
    pair.run(10'000);
    EXPECT_TRUE(pair.client.is_doubted()) << name << byte;
    EXPECT_EQ(pair.error, "") << "and it goes on";
    pair.run();
    EXPECT_EQ(pair.error, "R-SEA-2");
    EXPECT_EQ(pair.server.peers(), 0u);
    EXPECT_LE(sizes.size(), 30u) << "an answer to a repetition";
  }
  EXPECT_EQ(answers[0], answers[1]) << "a stranger cannot tell a known name from an unknown one";
  EXPECT_EQ(answers[0], answers[2]);
}

TEST(SealWrongKey, IsReportedWithinASecondThroughLoss) {
  int doubted = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    SealPair pair(key_of("lab", "5b"));
    std::mt19937 random(seed);
    pair.network_up = pair.network_down = [&random](const Bytes& datagram) {
      return random() % 10 == 0 ? std::vector<Bytes>{} : std::vector<Bytes>{datagram};
    };
    pair.run(1'000'000);
    doubted += pair.client.is_doubted() ? 1 : 0;
  }
  EXPECT_GE(doubted, 95);
}

/// The alert as anyone can send it, before and after every datagram of the handshake and later.
TEST(SealWrongKey, AForgedAlertEndsAndDelaysNothing) {
  const Bytes alert{21, 0xFE, 0xFD, 0, 0, 0, 0, 0, 0, 0, 9, 0, 2, 2, 51};
  SealPair quiet, disturbed;
  std::vector<Bytes> sent;
  disturbed.network_up = [&](const Bytes& datagram) {
    disturbed.down(alert);
    sent.push_back(datagram);
    return std::vector<Bytes>{datagram};
  };
  disturbed.network_down = [&](const Bytes& datagram) { return std::vector<Bytes>{alert, datagram, alert}; };
  quiet.run();
  disturbed.run();
  ASSERT_TRUE(disturbed.client.is_open());
  EXPECT_FALSE(disturbed.client.is_doubted()) << "the server is authenticated";
  EXPECT_EQ(disturbed.now, quiet.now);
  EXPECT_EQ(sent.size(), 3u) << "no datagram more";
  for (int i = 0; i < 100; ++i) disturbed.down(alert);
  EXPECT_FALSE(disturbed.client.is_doubted());
  EXPECT_EQ(disturbed.error, "");
  EXPECT_TRUE(disturbed.say_up("still there"));
}

/// What says that a key is wrong, and what does not.
TEST(SealWrongKey, OtherAlertsSayNothing) {
  SealPair pair(key_of("lab", "5b"));
  pair.network_down = [](const Bytes& datagram) {
    return datagram[0] == 21 ? std::vector<Bytes>{} : std::vector<Bytes>{datagram};
  };
  pair.run(100'000);
  ASSERT_FALSE(pair.client.is_doubted()) << "the server's alerts are lost";
  const Bytes alert{21, 0xFE, 0xFD, 0, 0, 0, 0, 0, 0, 0, 9, 0, 2, 2, 51};
  for (const auto& [at, byte] : {std::pair(0, 22), std::pair(4, 1), std::pair(13, 1), std::pair(14, 40), std::pair(14, 0)}) {
    Bytes other = alert;
    other[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(byte);
    pair.down(other);
    EXPECT_FALSE(pair.client.is_doubted()) << at;
  }
  pair.down(alert);
  EXPECT_TRUE(pair.client.is_doubted());
}

/// Somebody seals nonsense in the name of a client whose handshake is under way: the server complains, and lets the client in all the same.
TEST(SealWrongKey, AForgedFinishedKeepsNobodyOut) {
  SealPair pair;
  Bytes finished;
  pair.network_up = [&](const Bytes& datagram) {
    if (datagram.size() < 14 || datagram[13] != 16) return std::vector<Bytes>{datagram};  // ClientKeyExchange
    finished = datagram;
    finished.back() ^= 1u;
    return std::vector<Bytes>{finished};
  };
  pair.run(100'000);
  ASSERT_FALSE(finished.empty());
  EXPECT_TRUE(pair.client.is_doubted());
  EXPECT_EQ(pair.server.handshakes(), 1u);
  pair.network_up = [](const Bytes& datagram) { return std::vector<Bytes>{datagram}; };
  pair.run(1'000'000);
  EXPECT_TRUE(pair.client.is_open());
  EXPECT_TRUE(pair.say_up("in"));
}

}  // namespace
}  // namespace tactus::seal
