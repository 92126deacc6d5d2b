// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/bag_folder.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <tactus/base/rule.h>
#include <tactus/base/shown.h>
#include <tactus/base/text.h>
#include <tactus/trace/file_kind.h>
#include <tactus/trace/mcap_reader.h>

namespace tactus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostMetadata = 16u << 20;
constexpr std::size_t kMostFiles = 4096;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r' || text.back() == '\t')) text.remove_suffix(1);
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  return text;
}

std::string scalar(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front())
    text = text.substr(1, text.size() - 2);
  return std::string(text);
}

std::string in_lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

Diagnostic refused(Errc code, RuleName rule, std::string what, std::string remedy) {
  return {.error = fail(code, rule).value(), .cause = std::move(what), .remedy = std::move(remedy)};
}

/// Names with numbers in order of their numbers: bag_2 before bag_10.
bool comes_before(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto number = [&](const std::string& text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t begin = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return text.substr(begin, at - begin);
    };
    const std::string x = number(a, i), y = number(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  return a.size() - i < b.size() - j;
}

/// Time of the first message if a file's summary or its first message states it.
std::optional<std::uint64_t> start_of(const std::string& path) {
  auto source = ByteSource::open_file(path);
  if (!source) return std::nullopt;
  auto reader = mcap::Reader::open(std::move(*source));
  if (!reader) return std::nullopt;
  if (const auto statistics = reader->statistics(); statistics && statistics->message_count > 0)
    return statistics->message_start_time;
  for (;;) {
    const auto item = reader->next();
    if (!item || *item == mcap::Item::end) return std::nullopt;
    if (*item == mcap::Item::message) return reader->message().log_time;
  }
}

void sort_by_time(RecordingFiles& files) {
  std::vector<std::pair<std::uint64_t, std::string>> starts;
  for (const std::string& path : files.paths) {
    const auto start = start_of(path);
    if (!start) return;  // an empty or damaged file: the order of the list holds
    starts.emplace_back(*start, path);
  }
  const auto earlier = [](const auto& a, const auto& b) { return a.first < b.first; };
  if (std::is_sorted(starts.begin(), starts.end(), earlier)) return;
  std::stable_sort(starts.begin(), starts.end(), earlier);
  for (std::size_t i = 0; i < starts.size(); ++i) files.paths[i] = starts[i].second;
  files.notes.push_back(
      {"", "the files are read in order of their first messages, which is not the order in which they are listed", "", 1});
}

Result<std::string> read_text(const std::string& path) {
  TACTUS_TRY(ByteSource source, ByteSource::open_file(path));
  std::string text;
  std::vector<std::uint8_t> piece(64u << 10);
  for (;;) {
    TACTUS_TRY(const std::size_t got, source.read(piece));
    if (got == 0) return text;
    text.append(piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(got));
    if (text.size() > kMostMetadata) return fail(Errc::limit_exceeded, "R-TRC-5");
  }
}

/// A folder without metadata.yaml, or in which it names no files.
tl::expected<RecordingFiles, Diagnostic> files_by_name(const fs::path& folder) {
  RecordingFiles files;
  files.is_folder = true;
  std::error_code failed;
  std::vector<std::string> names;
  bool has_database = false, has_ros1 = false;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.') || !entry->is_regular_file(failed)) continue;
    const bool is_mcap =
        name.ends_with(".mcap") || name.ends_with(".mcap.zstd") || name.ends_with(".mcap.zst") || name.ends_with(".mcap.lz4");
    if (is_mcap) names.push_back(name);
    has_database |= name.ends_with(".db3") || name.ends_with(".db3.zstd");
    has_ros1 |= name.ends_with(".bag");
    if (names.size() > kMostFiles)
      return tl::unexpected(refused(Errc::limit_exceeded, "R-TRC-5", "the folder has over 4096 recordings", ""));
  }
  if (failed) return tl::unexpected(Diagnostic{.error = fail(Errc::io, "R-TRC-1").value()});
  if (names.empty()) {
    const char* what = has_database ? "the folder is a bag of databases (.db3), not of MCAP files"
                       : has_ros1   ? "the folder has bags of ROS 1 (.bag), no MCAP files"
                                    : "the folder has no recording: no metadata.yaml and no .mcap file";
    const char* remedy = has_database ? kConvertDatabase
                         : has_ros1   ? kConvertBag
                                      : "Give the folder that `ros2 bag record -s mcap` wrote, or a file.";
    return tl::unexpected(refused(Errc::unsupported, "R-TRC-2", what, remedy));
  }
  std::sort(names.begin(), names.end(), comes_before);
  for (const std::string& name : names) files.paths.push_back((folder / name).string());
  files.notes.push_back({"",
                         "the folder has no metadata.yaml that lists files; its " + std::to_string(names.size()) +
                             " MCAP files are read as one recording, in order of their names",
                         "", 1});
  return files;
}

tl::expected<RecordingFiles, Diagnostic> files_of_folder(const fs::path& folder, MissingFiles missing) {
  std::error_code failed;
  const fs::path listing = folder / "metadata.yaml";
  if (!fs::is_regular_file(listing, failed)) return files_by_name(folder);
  TACTUS_TRY(const std::string yaml, diagnosed(read_text(listing.string())));
  const BagMetadata metadata = parse_bag_metadata(yaml);
  if (!metadata.storage.empty() && metadata.storage != "mcap") {
    if (metadata.storage != "sqlite3")
      return tl::unexpected(
          refused(Errc::unsupported, "R-TRC-2", "the bag is stored as " + shown(metadata.storage) + ", not as MCAP", ""));
    return tl::unexpected(refused(Errc::unsupported, "R-TRC-2",
                                  "the folder is a bag of databases (storage sqlite3), not of MCAP files", kConvertDatabase));
  }
  const std::string format = in_lower_case(metadata.compression_format);
  const bool is_packed = !metadata.compression_mode.empty() && in_lower_case(metadata.compression_mode) != "none";
  if (is_packed && !format.empty() && format != "zstd" && format != "lz4")
    return tl::unexpected(refused(Errc::unsupported, "R-TRC-7",
                                  "the bag is compressed with " + shown(format) + "; zstd and LZ4 are read",
                                  "`ros2 bag convert` writes it without compression."));
  if (metadata.files.empty()) return files_by_name(folder);
  if (metadata.files.size() > kMostFiles)
    return tl::unexpected(refused(Errc::limit_exceeded, "R-TRC-5", "the bag has over 4096 files", ""));
  RecordingFiles files;
  files.is_folder = true;
  files.announced_messages = metadata.message_count;
  for (const std::string& name : metadata.files) {
    fs::path path = folder / fs::path(name).filename();  // a bag lies in one folder; nothing outside of it is opened, and no pipe
    // What was packed or unpacked by hand has got or lost an ending.
    for (const char* ending : {".zstd", ".zst"}) {
      if (fs::is_regular_file(path, failed)) break;
      const std::string text = path.string();
      if (fs::is_regular_file(text + ending, failed)) path = text + ending;
      else if (text.ends_with(ending) &&
               fs::is_regular_file(text.substr(0, text.size() - std::string_view(ending).size()), failed))
        path = text.substr(0, text.size() - std::string_view(ending).size());
    }
    if (fs::is_regular_file(path, failed)) {
      files.paths.push_back(path.string());
    } else if (missing == MissingFiles::refuse) {
      return tl::unexpected(refused(Errc::io, "R-TRC-1", "metadata.yaml lists " + shown(name) + ", which is not there",
                                    "Copy it into the folder, or save the rest: `tactus recover FOLDER -o rest.mcap`."));
    } else {
      files.notes.push_back({shown(name), "listed in metadata.yaml but not there; all of it is lost", "", 1});
    }
  }
  if (files.paths.empty()) return tl::unexpected(refused(Errc::io, "R-TRC-1", "no file that metadata.yaml lists is there", ""));
  sort_by_time(files);
  return files;
}

}  // namespace

BagMetadata parse_bag_metadata(std::string_view yaml) {
  BagMetadata metadata;
  std::size_t depth = 0;  // of the keys below rosbag2_bagfile_information; 0: not yet
  bool within_list = false, within_bag = false;
  while (!yaml.empty()) {
    const std::size_t end = std::min(yaml.find('\n'), yaml.size());
    const std::string_view line = yaml.substr(0, end);
    yaml.remove_prefix(std::min(end + 1, yaml.size()));
    const std::size_t indent = line.find_first_not_of(' ');
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    if (indent == 0) {
      within_bag = text == "rosbag2_bagfile_information:";
      depth = 0;
      continue;
    }
    if (!within_bag) continue;
    if (depth == 0) depth = indent;
    if (within_list && text.starts_with("- ") && indent >= depth) {
      metadata.files.push_back(scalar(text.substr(2)));
      continue;
    }
    if (indent != depth) continue;
    within_list = false;
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string_view key = text.substr(0, colon);
    std::string value = scalar(text.substr(std::min(colon + 1, text.size())));
    if (key == "storage_identifier") metadata.storage = std::move(value);
    else if (key == "compression_format") metadata.compression_format = std::move(value);
    else if (key == "compression_mode") metadata.compression_mode = std::move(value);
    else if (key == "message_count") metadata.message_count = parse_number<std::uint64_t>(value);
    else if (key == "relative_file_paths") within_list = value.empty();
  }
  return metadata;
}

std::string RecordingFiles::name(std::size_t number) const {
  return paths.size() < 2 ? std::string() : fs::path(paths[number]).filename().string();
}

std::optional<std::uint64_t> RecordingFiles::bytes() const {
  std::uint64_t sum = memory.size();
  for (const std::string& path : paths) {
    std::error_code failed;
    const std::uint64_t size = fs::file_size(path, failed);
    if (failed) return std::nullopt;
    sum += size;
  }
  return sum;
}

Result<ByteSource> RecordingFiles::open(std::size_t number) const {
  if (paths.empty()) return ByteSource::over_memory(memory);
  return ByteSource::open_file(paths[number]);
}

tl::expected<RecordingFiles, Diagnostic> files_of(const std::string& path, MissingFiles missing) try {
  std::error_code failed;
  if (path != "-" && fs::is_directory(path, failed)) return files_of_folder(path, missing);
  if (fs::path(path).filename() == "metadata.yaml" && fs::exists(path, failed)) {
    const fs::path folder = fs::path(path).parent_path();
    return files_of_folder(folder.empty() ? fs::path(".") : folder, missing);
  }
  return RecordingFiles{.paths = {path}};
} catch (const std::bad_alloc&) {
  return tl::unexpected(Diagnostic{.error = out_of_memory().value()});
} catch (const fs::filesystem_error&) {
  return tl::unexpected(Diagnostic{.error = fail(Errc::io, "R-TRC-1").value()});
}

}  // namespace tactus
