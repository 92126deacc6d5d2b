// SPDX-License-Identifier: Apache-2.0
#include "cli/options/headings.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace tactus::cli {

// ==== suggestion ====

namespace {

/// Letters to insert, remove, replace or swap with the next (optimal string alignment).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last.back();
}

}  // namespace

std::string did_you_mean(std::string_view typed, std::span<const std::string> names) {
  constexpr std::size_t kLongest = 64;  // what is longer is no slip
  if (typed.size() > kLongest) return {};
  std::string nearest;
  std::size_t least = typed.size();
  for (const std::string& name : names) {
    const std::size_t steps = distance(typed, name);
    if (steps >= least || 3 * steps > std::max<std::size_t>(name.size(), 3)) continue;
    least = steps;
    nearest = name;
  }
  return nearest.empty() ? std::string() : ". Did you mean " + nearest + "?";
}

// ==== headings ====

namespace {

struct Row {
  std::string_view name, heading;
};

constexpr std::string_view kBounds = "Bounds", kCoding = "Coding", kRigid = "Coding of rigid objects",
                           kDeformable = "Coding of deformable objects", kDeformation = "Simulation of deformable objects",
                           kHand = "Virtual hand", kDevice = "Device", kNetwork = "Network", kRecording = "Recording",
                           kWatch = "Operation", kOutput = "Output", kTuning = "Tuning";

constexpr std::array kOptions{
    Row{"--deadband", kBounds},
    Row{"--haptic", kBounds},
    Row{"--visual", kBounds},
    Row{"--deformable-visual", kBounds},
    Row{"--profile", kCoding},
    Row{"--codec", kCoding},
    Row{"--interpolate", kRigid},
    Row{"--basis", kDeformable},
    Row{"--check", kOutput},
    Row{"--method", kDeformation},
    Row{"--grip", kHand},
    Row{"--playback-rate", kDevice},
    Row{"--replay", kHand},
    Row{"--device", kDevice},
    Row{"--firmware", kDevice},
    Row{"--force-limit", kDevice},
    Row{"--scale", kDevice},
    Row{"--listen", kNetwork},
    Row{"--to", kNetwork},
    Row{"--link", kNetwork},
    Row{"--uplink", kNetwork},
    Row{"--playout", kNetwork},
    Row{"--compensation", kNetwork},
    Row{"--clients", kNetwork},
    Row{"--key", kNetwork},
    Row{"--observe", kWatch},
    Row{"--metrics", kWatch},
    Row{"--log", kWatch},
    Row{"--check", kWatch},
    Row{"--subject", kRecording},
    Row{"--remarks", kRecording},
    Row{"--output", kOutput},
    Row{"--stream", kOutput},
    Row{"--pcap", kOutput},
    Row{"--stiffness-map", kOutput},
    Row{"--json", kOutput},
    Row{"--quiet", kOutput},
    Row{"--no-progress", kOutput},
    Row{"--force", kOutput},
    Row{"--tune", kTuning},
};

// What people tune seldom, behind --tune: under which heading --help-tune lists it, and the option that it once was.
struct Key {
  std::string_view name, heading;
  std::string_view was = {};  ///< empty: --NAME, with - for _
  std::string_view now = {};  ///< how it is typed in place of that; empty: NAME=...
};

constexpr std::array kKeys{
    Key{"alpha", kBounds},
    Key{"jnd_fraction", kBounds, "--jnd-share"},
    Key{"fixed", kBounds},
    Key{"force_floor", kBounds},
    Key{"rings", kBounds},
    Key{"length_unit", kBounds},
    Key{"world_size", kCoding},
    Key{"key_interval", kCoding},
    Key{"heartbeat", kRigid},
    Key{"reduction", kRigid, "--no-reduction", "reduction=none"},
    Key{"gravity", kRigid},
    Key{"friction", kRigid},
    Key{"clusters", kDeformable},
    Key{"fade", kDeformable},
    Key{"nugget", kDeformable},
    Key{"visual_fraction", kDeformable, "--visual-fraction"},
    Key{"haptic_fraction", kDeformable, "--haptic-fraction"},
    Key{"quant_bits", kDeformable},
    Key{"keep_models", kDeformable, {}, "keep_models=on"},
    Key{"layered", kDeformable, {}, "layered=on"},
    Key{"solver", kDeformation},
    Key{"deformable_noise", kDeformation},
    Key{"duration_scale", kHand, "--pace"},
    Key{"tremor", kHand},
    Key{"loop", kDevice, {}, "loop=on"},
    Key{"service", kDevice},
    Key{"runtime", kDevice},
    Key{"device_error", kDevice},
    Key{"device_deadband", kDevice},
    Key{"client_model_scale", kNetwork, "--told"},
};

// Of `import`, where some options mean what no other command means by them.
constexpr std::string_view kColumns = "Columns", kMeaning = "Units, order and axes", kTimes = "Times and missing samples",
                           kText = "Text";

constexpr std::array kImportOptions{
    Row{"--preset", kColumns},
    Row{"--list-presets", kColumns},
    Row{"--map", kColumns},
    Row{"--time", kColumns},
    Row{"--segment", kColumns},
    Row{"--object-column", kColumns},
    Row{"--object", kColumns},
    Row{"--user", kColumns},
    Row{"--length-unit", kMeaning},
    Row{"--time-unit", kMeaning},
    Row{"--angle-unit", kMeaning},
    Row{"--force-unit", kMeaning},
    Row{"--quaternion-order", kMeaning},
    Row{"--euler-order", kMeaning},
    Row{"--date-order", kMeaning},
    Row{"--axes", kMeaning},
    Row{"--angular-velocity-frame", kMeaning},
    Row{"--tick-rate", kTimes},
    Row{"--rate", kTimes},
    Row{"--stamps", kTimes},
    Row{"--gap", kTimes},
    Row{"--no-resample", kTimes},
    Row{"--restarts", kTimes},
    Row{"--strict", kTimes},
    Row{"--skip-lines", kText},
    Row{"--names", kText},
    Row{"--missing", kText},
    Row{"--keep-last", kText},
    Row{"--skip-bad", kText},
};

constexpr std::string_view kCodec = "Codec", kScenes = "Scenes", kTraces = "Traces", kLive = "Devices and sessions",
                           kStudies = "Studies", kHelp = "Help";

constexpr std::array kCommands{
    Row{"sim", kScenes},       Row{"mesh", kScenes},  Row{"encode", kCodec},    Row{"decode", kCodec},
    Row{"compare", kCodec},    Row{"info", kCodec},   Row{"import", kTraces},   Row{"export", kTraces},
    Row{"cut", kTraces},       Row{"merge", kTraces}, Row{"resample", kTraces}, Row{"recover", kTraces},
    Row{"tolerable", kTraces}, Row{"view", kTraces},  Row{"plot", kTraces},     Row{"devices", kLive},
    Row{"capture", kLive},     Row{"play", kLive},    Row{"serve", kLive},      Row{"join", kLive},
    Row{"link", kLive},        Row{"key", kLive},     Row{"sweep", kStudies},   Row{"reproduce", kStudies},
    Row{"bench", kStudies},    Row{"help", kHelp},    Row{"completion", kHelp},
};

template <std::size_t N>
std::string find(const std::array<Row, N>& rows, std::string_view name, std::string_view otherwise) {
  const auto* row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.name == name; });
  return std::string(row == rows.end() ? otherwise : row->heading);
}

}  // namespace

std::string heading_of(std::string_view option, std::string_view group) {
  constexpr std::string_view kTune = "--tune ";
  if (option.starts_with(kTune)) {
    const auto* const key = std::ranges::find(kKeys, option.substr(kTune.size()), &Key::name);
    return std::string(key == kKeys.end() ? "Options" : key->heading);
  }
  const std::string heading = find(kOptions, option, "Options");
  return group == "import" ? find(kImportOptions, option, heading) : heading;
}
std::string key_instead_of(std::string_view option, std::span<const std::string> keys) {
  for (const Key& key : kKeys) {
    std::string was(key.was);
    if (was.empty()) {
      was = fmt::format("--{}", key.name);
      std::ranges::replace(was, '_', '-');
    }
    if (was != option || std::ranges::find(keys, key.name) == keys.end()) continue;
    return key.now.empty() ? fmt::format("{}=...", key.name) : std::string(key.now);
  }
  return {};
}

std::string heading_of_command(std::string_view command) { return find(kCommands, command, "More commands"); }

}  // namespace tactus::cli
