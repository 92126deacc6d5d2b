// SPDX-License-Identifier: Apache-2.0
/// Every field of every record of the MCAP container is changed in turn: what is read changes, or the file is refused, or the field stands in
/// the list below with the reason why it may be ignored.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include <tactus/base/bytes.h>
#include <tactus/trace/mcap_reader.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

const std::map<std::string, std::string> kIgnored{
    {"header.profile", "a hint for tools; the channels say what they carry"},
    {"header.library", "who wrote the file changes no number"},
    {"chunk.message_start_time", "an index: the messages have their own times; reported when the chunk is damaged"},
    {"chunk.message_end_time", "an index: the messages have their own times; reported when the chunk is damaged"},
    {"message_index.channel_id", "an index: the file is read front to back"},
    {"message_index.records", "an index: the file is read front to back"},
    {"chunk_index.content", "an index: the file is read front to back"},
    {"footer.summary_offset_start", "an index: the file is read front to back"},
    {"message_index.opcode", "an index, and the index of another kind that it becomes, are both passed over"},
    {"chunk_index.opcode", "an index, and the index of another kind that it becomes, are both passed over"},
    {"unknown.opcode", "records of later versions are skipped"},
    {"unknown.content", "records of later versions are skipped"},
};

struct Field {
  std::string name;
  std::size_t at, size;
};

class Builder {
 public:
  Builder() { raw("magic", Bytes(mcap::kMagic.begin(), mcap::kMagic.end())); }
  template <class Fill>
  void record(std::uint8_t opcode, const std::string& name, const Fill& fill) {
    number(name + ".opcode", opcode, 1);
    const std::size_t length = bytes.size();
    number(name + ".length", 0, 8);
    name_ = name;
    fill();
    put(length, bytes.size() - length - 8, 8);
  }
  void u(const std::string& field, std::uint64_t value, unsigned size) { number(name_ + "." + field, value, size); }
  void text(const std::string& field, const std::string& value) {
    number(name_ + "." + field + ".length", value.size(), 4);
    raw(name_ + "." + field, Bytes(value.begin(), value.end()));
  }
  void map(const std::string& field, const std::string& key, const std::string& value) {
    number(name_ + "." + field + ".size", 8 + key.size() + value.size(), 4);
    text(field + ".key", key);
    text(field + ".value", value);
  }
  void raw(const std::string& field, const Bytes& data) {
    fields.push_back({field, bytes.size(), data.size()});
    bytes.insert(bytes.end(), data.begin(), data.end());
  }
  void put(std::size_t at, std::uint64_t value, unsigned size) {
    for (unsigned i = 0; i < size; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  const std::string& name() const { return name_; }

  Bytes bytes;
  std::vector<Field> fields;

 private:
  void number(const std::string& field, std::uint64_t value, unsigned size) {
    fields.push_back({field, bytes.size(), size});
    bytes.resize(bytes.size() + size);
    put(bytes.size() - size, value, size);
  }
  std::string name_;
};

void add_message(Builder& file, const std::string& name) {
  file.record(5, name, [&] {
    file.u("channel_id", 1, 2);
    file.u("sequence", 7, 4);
    file.u("log_time", 1000, 8);
    file.u("publish_time", 900, 8);
    file.raw(name + ".data", {1, 2, 3});
  });
}

Builder make_file() {
  Builder f;
  f.record(1, "header", [&] { f.text("profile", "ros2"), f.text("library", "test"); });
  f.record(3, "schema", [&] { f.u("id", 1, 2), f.text("name", "S"), f.text("encoding", "ros2msg"), f.text("data", "int8 x"); });
  f.record(4, "channel", [&] {
    f.u("id", 1, 2), f.u("schema_id", 1, 2), f.text("topic", "/t"), f.text("encoding", "cdr"), f.map("metadata", "k", "v");
  });
  f.record(12, "metadata", [&] { f.text("name", "m"), f.map("entries", "key", "value"); });
  f.record(9, "attachment", [&] {
    const std::size_t start = f.bytes.size();
    f.u("log_time", 5, 8), f.u("create_time", 6, 8), f.text("name", "a.txt"), f.text("media_type", "text/plain");
    f.u("data.length", 2, 8);
    f.raw("attachment.data", {8, 9});
    f.u("crc", crc32(std::span<const std::uint8_t>(f.bytes).subspan(start)), 4);
  });
  f.record(6, "chunk", [&] {
    Builder inner;
    inner.bytes.clear();
    inner.fields.clear();
    add_message(inner, "chunk.message");
    f.u("message_start_time", 1000, 8), f.u("message_end_time", 1000, 8), f.u("uncompressed_size", inner.bytes.size(), 8);
    f.u("crc", crc32(std::span<const std::uint8_t>(inner.bytes)), 4), f.text("compression", ""),
        f.u("records.length", inner.bytes.size(), 8);
    for (const Field& field : inner.fields)
      f.raw(field.name, Bytes(inner.bytes.begin() + static_cast<std::ptrdiff_t>(field.at),
                              inner.bytes.begin() + static_cast<std::ptrdiff_t>(field.at + field.size)));
  });
  f.record(7, "message_index", [&] { f.u("channel_id", 1, 2), f.u("records.length", 0, 4); });
  f.fields.back().name = "message_index.records";
  add_message(f, "message");
  f.record(0x80, "unknown", [&] { f.raw("unknown.content", {1}); });
  const std::size_t data_end = f.bytes.size();
  f.record(15, "data_end", [&] { f.u("crc", 0, 4); });
  f.put(data_end + 9, crc32(std::span<const std::uint8_t>(f.bytes).first(data_end)), 4);
  const std::size_t summary = f.bytes.size();
  f.record(11, "statistics", [&] {
    f.u("message_count", 2, 8), f.u("schema_count", 1, 2), f.u("channel_count", 1, 4), f.u("attachment_count", 1, 4),
        f.u("metadata_count", 1, 4);
    f.u("chunk_count", 1, 4), f.u("message_start_time", 1000, 8), f.u("message_end_time", 1000, 8), f.u("counts.length", 10, 4);
    f.u("counts.channel", 1, 2), f.u("counts.count", 2, 8);
  });
  f.record(8, "chunk_index", [&] { f.raw("chunk_index.content", Bytes(30)); });
  const std::size_t footer = f.bytes.size();
  f.record(2, "footer", [&] { f.u("summary_start", summary, 8), f.u("summary_offset_start", 0, 8), f.u("crc", 0, 4); });
  f.put(footer + 9 + 16, crc32(std::span<const std::uint8_t>(f.bytes).subspan(summary, footer + 25 - summary)), 4);
  f.raw("end", Bytes(mcap::kMagic.begin(), mcap::kMagic.end()));
  return f;
}

/// All that a reader hands out, or what refuses the file.
std::string all_of(const Bytes& bytes) {
  std::ostringstream out;
  auto reader = mcap::Reader::open(ByteSource::over_memory(bytes));
  if (!reader) return std::string("refused ") + reader.error().error.rule;
  if (const auto s = reader->statistics()) {
    out << s->message_count << ' ' << s->schema_count << ' ' << s->channel_count << ' ' << s->attachment_count << ' '
        << s->metadata_count << ' ' << s->chunk_count << ' ' << s->message_start_time << ' ' << s->message_end_time;
    for (const auto& [id, count] : s->channel_message_counts) out << ' ' << id << ':' << count;
  }
  const auto put_map = [&](const mcap::TextMap& map) {
    for (const auto& [key, value] : map) out << key << '=' << value << ';';
  };
  for (;;) {
    const auto item = reader->next();
    if (!item) return std::string("refused ") + item.error().rule;
    if (*item == mcap::Item::end) break;
    out << '\n' << static_cast<int>(*item) << ' ';
    if (*item == mcap::Item::message) {
      const mcap::Message& m = reader->message();
      out << m.channel_id << ' ' << m.sequence << ' ' << m.log_time << ' ' << m.publish_time << ' '
          << std::string(m.data.begin(), m.data.end());
    } else if (*item == mcap::Item::attachment) {
      const mcap::Attachment& a = reader->attachment();
      out << a.log_time << ' ' << a.create_time << ' ' << a.name << ' ' << a.media_type << ' '
          << std::string(a.data.begin(), a.data.end());
    } else {
      out << reader->metadata().name << ' ';
      put_map(reader->metadata().entries);
    }
  }
  for (const auto& [id, schema] : reader->schemas()) out << '\n' << id << schema.name << schema.encoding << schema.data;
  for (const auto& [id, channel] : reader->channels()) {
    out << '\n' << id << channel.schema_id << channel.topic << channel.message_encoding;
    put_map(channel.metadata);
  }
  out << '\n' << reader->cut_short();
  return out.str();
}

/// Without check values, so that they do not hide what the fields themselves do.
Bytes without_checks(const Builder& file) {
  Bytes bytes = file.bytes;
  for (const Field& field : file.fields)
    if (field.name.ends_with(".crc"))
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(field.at), field.size, std::uint8_t{0});
  return bytes;
}

TEST(TraceMcapFields, EachFieldCountsOrIsListedAsIgnored) {
  const Builder file = make_file();
  const Bytes bytes = without_checks(file);
  const std::string before = all_of(bytes);
  ASSERT_FALSE(before.starts_with("refused")) << before;
  ASSERT_EQ(all_of(file.bytes), before);
  std::map<std::string, bool> ignored;
  for (const Field& field : file.fields) {
    if (field.name.ends_with(".crc")) continue;
    for (std::size_t i = 0; i < field.size; ++i)
      for (const std::uint8_t bit : {std::uint8_t{0x01}, std::uint8_t{0x02}, std::uint8_t{0x20}}) {
        Bytes changed = bytes;
        changed[field.at + i] ^= bit;
        const auto listed = kIgnored.find(field.name);
        const bool counts = all_of(changed) != before;
        if (listed == kIgnored.end()) EXPECT_TRUE(counts) << field.name << ", byte " << i << ", bit " << int{bit};
        else if (!counts) ignored[field.name] = true;
      }
  }
  for (const auto& [name, reason] : kIgnored) EXPECT_TRUE(ignored.contains(name)) << name << " is listed, but counts";
}

TEST(TraceMcapFields, CheckValuesGuardEveryByteTheyCover) {
  const Builder file = make_file();
  for (const Field& field : file.fields) {
    Bytes changed = file.bytes;
    for (std::size_t i = 0; i < field.size; ++i) {
      changed[field.at + i] ^= 0x10;
      const std::string after = all_of(changed);
      EXPECT_NE(after, all_of(file.bytes)) << field.name << ", byte " << i;
      changed[field.at + i] ^= 0x10;
    }
  }
}

}  // namespace
}  // namespace tactus
