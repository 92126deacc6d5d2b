// SPDX-License-Identifier: Apache-2.0
// A reader of our own over nlohmann's JSON, whose parser does not recurse: tinygltf 2.7 overflows the stack on 100 000 nested extras, and opens
// whatever path a file names.
#include <tactus/sim/surface/gltf_file.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include <tactus/base/text.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

using Json = nlohmann::json;
using Read = tl::expected<void, Diagnostic>;

constexpr std::size_t kMostJson = std::size_t{128} << 20;   // bytes
constexpr std::size_t kMostBytes = std::size_t{512} << 20;  // of all buffers
constexpr std::size_t kMostValues = std::size_t{1} << 21;   // of the JSON
constexpr int kDeepest = 64;

struct TooMuch {
  const char* what;
};

/// The JSON without extras.   err  R-SRF-2, R-SRF-4
tl::expected<Json, Diagnostic> parse_json(std::string_view text) {
  if (text.size() > kMostJson) {
    auto refused = broken(Errc::limit_exceeded, "R-SRF-2", "more than 128 MiB of JSON");
    refused.value().remedy = "Write it as .glb, whose buffers are bytes.";
    return refused;
  }
  std::size_t values = 0;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kDeepest) throw TooMuch{"is nested more than 64 deep"};
    if (++values > kMostValues) throw TooMuch{"has more than 2^21 values"};
    return event != Json::parse_event_t::key || parsed.get_ref<const std::string&>() != "extras";
  };
  try {
    Json out = Json::parse(text.begin(), text.end(), watch);
    if (!out.is_object()) return broken(Errc::malformed, "R-SRF-4", "JSON, but no object");
    return out;
  } catch (const TooMuch& much) {
    return broken(Errc::limit_exceeded, "R-SRF-2", std::string("its JSON ") + much.what);
  } catch (const Json::exception& e) {
    const std::string_view what = e.what();
    return broken(Errc::malformed, "R-SRF-4", std::string(what.substr(0, 160)));
  }
}

// ==== model ====

/// Keeps the first error; after it, everything read is 0 or nothing.
class GltfReader {
 public:
  GltfReader(const Json& root, std::string_view binary, const std::string& folder)
      : root_(root), binary_(binary), folder_(folder) {}

  tl::expected<GltfFile, Diagnostic> read(ReadNotes&& notes) {
    file_.notes = std::move(notes);
    read_head();
    each("buffers", [&](const Json& item) { read_buffer(item); });
    each("bufferViews", [&](const Json& item) { read_view(item); });
    each("accessors", [&](const Json& item) { read_accessor_of(item); });
    each("meshes", [&](const Json& item) { read_mesh(item); });
    each("nodes", [&](const Json& item) { read_node(item); });
    each("skins", [&](const Json& item) {
      file_.skins.push_back({indices(item, "joints", "nodes"), index(item, "inverseBindMatrices", "accessors")});
    });
    each("animations", [&](const Json& item) { read_animation(item); });
    read_scene();
    if (error_) return tl::unexpected(*error_);
    return std::move(file_);
  }

 private:
  // ==== values ====

  /// err  the first is kept
  void fail_at(std::string_view key, const std::string& why, RuleName rule = "R-SRF-4", Errc code = Errc::malformed) {
    if (error_) return;
    std::string detail = array_.empty() ? "" : array_ + '[' + std::to_string(item_) + ']';
    if (!key.empty()) detail += (detail.empty() ? "" : ".") + std::string(key);
    error_ = broken(code, rule, detail + ": " + why).value();
  }

  const Json* find(const Json& object, const char* key) const {
    if (error_ || !object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
  }

  const Json* list_of(const Json& object, const char* key) {
    const Json* found = find(object, key);
    if (found == nullptr || found->is_array()) return found;
    fail_at(key, "not an array");
    return nullptr;
  }

  template <class Use>
  void each(const char* key, Use use) {
    array_.clear();
    const Json* list = list_of(root_, key);
    for (std::size_t i = 0; list != nullptr && i < list->size() && !error_; ++i) {
      array_ = key;
      item_ = i;
      if (!(*list)[i].is_object()) fail_at("", "not an object");
      use((*list)[i]);
    }
    array_.clear();
  }

  std::size_t count_in(const char* key) const {
    const auto found = root_.find(key);
    return found == root_.end() || !found->is_array() ? 0 : found->size();
  }

  std::optional<std::size_t> whole(const Json& value, std::string_view key) {
    if (value.is_number_unsigned()) return value.get<std::size_t>();
    const double real = value.is_number() ? value.get<double>() : -1;
    if (real >= 0 && real <= 9e15 && std::floor(real) == real) return static_cast<std::size_t>(real);
    fail_at(key, "not a whole number from 0");
    return std::nullopt;
  }

  std::size_t size(const Json& object, const char* key, std::size_t otherwise = 0) {
    const Json* found = find(object, key);
    return found == nullptr ? otherwise : whole(*found, key).value_or(0);
  }

  /// An index of the array `into` of the file.
  Index index(const Json& object, const char* key, const char* into) {
    const Json* found = find(object, key);
    return found == nullptr ? std::nullopt : index_of(*found, key, into);
  }
  Index index_of(const Json& value, std::string_view key, const char* into) {
    const auto number = whole(value, key);
    if (!number || *number < count_in(into)) return number;
    fail_at(key, "no " + std::string(into) + '[' + std::to_string(*number) + ']');
    return std::nullopt;
  }
  std::size_t needed(const Json& object, const char* key, const char* into) {
    const Index found = index(object, key, into);
    if (!found) fail_at(key, "missing");
    return found.value_or(0);
  }

  std::vector<std::size_t> indices(const Json& object, const char* key, const char* into) {
    std::vector<std::size_t> out;
    if (const Json* list = list_of(object, key))
      for (const Json& value : *list) out.push_back(index_of(value, key, into).value_or(0));
    return out;
  }

  std::vector<double> numbers(const Json& object, const char* key) {
    std::vector<double> out;
    if (const Json* list = list_of(object, key)) {
      for (const Json& value : *list) {
        if (!value.is_number()) fail_at(key, "not a number");
        out.push_back(value.is_number() ? value.get<double>() : 0);
      }
    }
    return out;
  }
  /// Nothing: the key is not there.
  std::optional<std::vector<double>> numbers(const Json& object, const char* key, std::size_t count) {
    if (find(object, key) == nullptr) return std::nullopt;
    auto out = numbers(object, key);
    if (out.size() != count) fail_at(key, "not " + std::to_string(count) + " numbers");
    out.resize(count);
    return out;
  }

  std::string text(const Json& object, const char* key) {
    const Json* found = find(object, key);
    if (found == nullptr) return {};
    if (!found->is_string()) fail_at(key, "not a text");
    return found->is_string() ? found->get<std::string>() : "";
  }

  // ==== parts ====

  /// A version that is read; extensions that must be understood, and those that say something of shape or motion.
  void read_head() {
    const Json* asset = find(root_, "asset");
    const Json* stated = asset == nullptr ? nullptr : find(*asset, "version");
    const std::string version = stated == nullptr ? "" : stated->is_string() ? stated->get<std::string>() : stated->dump();
    const bool known = version.starts_with("2.") && parse_number<unsigned>(std::string_view(version).substr(2)).has_value();
    if (!known) {
      fail_at("asset.version", "'" + version.substr(0, 20) + "', not 2.0", "R-SRF-3", Errc::unsupported);
      error_->remedy = kOldGltf;
    }
    const auto is_look = [](std::string_view name) {
      for (const auto* front : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_", "EXT_lights_"})
        if (name.starts_with(front)) return true;
      return name == "KHR_mesh_quantization" || name == "KHR_xmp_json_ld" || name == "KHR_xmp" ||
             name == "KHR_draco_mesh_compression";
    };
    for (const char* key : {"extensionsRequired", "extensionsUsed"}) {
      const Json* list = list_of(root_, key);
      for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
        const std::string name = (*list)[i].is_string() ? (*list)[i].get<std::string>() : "";
        const bool required = std::string_view(key) == "extensionsRequired";
        if (required && (!is_look(name) || name == "KHR_draco_mesh_compression")) {
          fail_at(key, name, "R-SRF-3", Errc::unsupported);
          if (error_->remedy.empty())
            error_->remedy = "Write it again without " + name + ": gltf-transform copy, or Blender's export without compression.";
        }
        if (!required && !is_look(name)) file_.notes.add("", "the extension " + name + " is left out");
      }
    }
  }

  void read_buffer(const Json& item) {
    const std::size_t length = size(item, "byteLength");
    std::string_view bytes;
    if (const Json* uri = find(item, "uri")) {
      const std::string_view name = uri->is_string() ? std::string_view(uri->get_ref<const std::string&>()) : "";
      if (name.starts_with("data:")) {
        const std::size_t comma = name.find(',');
        const bool is_base64 = comma != std::string_view::npos && name.substr(0, comma).ends_with(";base64");
        auto decoded = is_base64 ? decode_base64(name.substr(comma + 1)) : std::nullopt;
        if (!decoded) return fail_at("uri", "not data in base64");
        bytes = file_.held.emplace_back(std::move(*decoded));
      } else {
        auto read = read_beside(folder_, name, std::min(length, kMostBytes));
        if (!read) {
          if (!error_) error_ = read.error();
          return;
        }
        bytes = file_.held.emplace_back(std::move(*read));
      }
    } else if (item_ == 0) {
      bytes = binary_;
    }
    held_ += bytes.size();
    if (held_ > kMostBytes) return fail_at("", "more than 512 MiB in all", "R-SRF-2", Errc::limit_exceeded);
    if (length > bytes.size())
      return fail_at("byteLength", std::to_string(length) + ", but there are " + std::to_string(bytes.size()) + " bytes",
                     "R-SRF-5");
    buffers_.push_back(bytes.substr(0, length));
  }

  void read_view(const Json& item) {
    const std::size_t buffer = needed(item, "buffer", "buffers"), offset = size(item, "byteOffset"),
                      length = size(item, "byteLength");
    const std::size_t stride = size(item, "byteStride");
    if (error_) return;
    const std::string_view bytes = buffers_[buffer];
    if (offset > bytes.size() || length > bytes.size() - offset)
      return fail_at("byteLength", "it ends behind its buffer", "R-SRF-5");
    if (stride > 252) return fail_at("byteStride", "more than 252");
    file_.views.push_back({bytes.substr(offset, length), stride});
  }

  std::size_t component(const Json& item) {
    const std::size_t out = size(item, "componentType");
    if (gltf_component_size(out) == 0) fail_at("componentType", std::to_string(out));
    return out;
  }

  void read_accessor_of(const Json& item) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kTypes{
        {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
    const std::string type = text(item, "type");
    const auto known = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == type; });
    if (known == kTypes.end()) return fail_at("type", '\'' + type.substr(0, 20) + '\'');
    const Json* normalized = find(item, "normalized");
    GltfAccessor out{.view = index(item, "bufferView", "bufferViews"),
                     .offset = size(item, "byteOffset"),
                     .component = component(item),
                     .count = size(item, "count"),
                     .width = known->second,
                     .normalized = normalized != nullptr && normalized->is_boolean() && normalized->get<bool>(),
                     .sparse = {}};
    if (out.count == 0) fail_at("count", "0");
    if (const Json* sparse = find(item, "sparse")) {
      const Json none = Json::object();
      const Json *at = find(*sparse, "indices"), *values = find(*sparse, "values");
      if (at == nullptr || values == nullptr) return fail_at("sparse", "without indices or values");
      out.sparse = GltfAccessor::Sparse{.count = size(*sparse, "count"),
                                        .index_view = needed(*at, "bufferView", "bufferViews"),
                                        .index_offset = size(*at, "byteOffset"),
                                        .index_component = component(*at),
                                        .value_view = needed(*values, "bufferView", "bufferViews"),
                                        .value_offset = size(*values, "byteOffset")};
    }
    file_.accessors.push_back(out);
  }

  void read_mesh(const Json& item) {
    GltfMesh& mesh = file_.meshes.emplace_back();
    mesh.weights = numbers(item, "weights");
    const Json* primitives = list_of(item, "primitives");
    for (std::size_t i = 0; primitives != nullptr && i < primitives->size() && !error_; ++i) {
      const Json& from = (*primitives)[i];
      const Json *attributes = find(from, "attributes"), *extensions = find(from, "extensions");
      GltfPrimitive& out = mesh.primitives.emplace_back();
      out.mode = size(from, "mode", 4);
      out.indices = index(from, "indices", "accessors");
      if (extensions != nullptr && extensions->contains("KHR_draco_mesh_compression"))
        file_.notes.add("", "the compressed form (KHR_draco_mesh_compression) is left out, the plain one is read");
      if (attributes == nullptr) continue;
      out.position = index(*attributes, "POSITION", "accessors");
      for (std::size_t set = 0; attributes->contains("JOINTS_" + std::to_string(set)); ++set) {
        const std::string number = std::to_string(set);
        out.joints.push_back(needed(*attributes, ("JOINTS_" + number).c_str(), "accessors"));
        out.weights.push_back(needed(*attributes, ("WEIGHTS_" + number).c_str(), "accessors"));
      }
      if (const Json* targets = list_of(from, "targets"))
        for (const Json& target : *targets) out.targets.push_back(index(target, "POSITION", "accessors"));
    }
  }

  void read_node(const Json& item) {
    GltfNode& node = file_.nodes.emplace_back();
    node.name = text(item, "name");
    node.mesh = index(item, "mesh", "meshes");
    node.skin = index(item, "skin", "skins");
    node.children = indices(item, "children", "nodes");
    node.weights = numbers(item, "weights");
    if (const auto m = numbers(item, "matrix", 16)) {
      std::copy(m->begin(), m->end(), node.matrix.emplace().begin());
      if ((*m)[3] != 0 || (*m)[7] != 0 || (*m)[11] != 0 || (*m)[15] != 1) fail_at("matrix", "its last row is not 0, 0, 0, 1");
    }
    if (const auto t = numbers(item, "translation", 3)) node.pose.position = {(*t)[0], (*t)[1], (*t)[2]};
    if (const auto q = numbers(item, "rotation", 4)) {
      const double length = std::hypot(std::hypot((*q)[0], (*q)[1]), std::hypot((*q)[2], (*q)[3]));
      if (!(std::abs(length - 1) <= 0.02)) return fail_at("rotation", "its length is not 1");
      node.pose.rotation = {(*q)[3] / length, (*q)[0] / length, (*q)[1] / length, (*q)[2] / length};
    }
    if (const auto s = numbers(item, "scale", 3)) node.scale = {(*s)[0], (*s)[1], (*s)[2]};
  }

  void read_animation(const Json& item) {
    GltfAnimation& animation = file_.animations.emplace_back();
    animation.name = text(item, "name");
    const Json *channels = list_of(item, "channels"), *samplers = list_of(item, "samplers");
    for (std::size_t i = 0; channels != nullptr && i < channels->size() && !error_; ++i) {
      const Json* target = find((*channels)[i], "target");
      const std::size_t sampler = size((*channels)[i], "sampler");
      if (target == nullptr || samplers == nullptr || sampler >= samplers->size())
        return fail_at("channels", "without target or sampler");
      const Json& from = (*samplers)[sampler];
      const Index node = index(*target, "node", "nodes");
      const std::string path = text(*target, "path"), how = text(from, "interpolation");
      constexpr std::array<std::string_view, 4> kPaths{"translation", "rotation", "scale", "weights"};
      const auto known = std::find(kPaths.begin(), kPaths.end(), path);
      if (!node || known == kPaths.end()) {
        file_.notes.add("", "channels of an animation that move no node are left out (" + path.substr(0, 20) + ')');
        continue;
      }
      if (!how.empty() && how != "LINEAR" && how != "STEP" && how != "CUBICSPLINE")
        return fail_at("interpolation", how.substr(0, 20));
      animation.channels.push_back({.node = *node,
                                    .input = needed(from, "input", "accessors"),
                                    .output = needed(from, "output", "accessors"),
                                    .path = static_cast<GltfPath>(known - kPaths.begin()),
                                    .interpolation = how == "STEP"          ? GltfInterpolation::step
                                                     : how == "CUBICSPLINE" ? GltfInterpolation::cubic_spline
                                                                            : GltfInterpolation::linear});
    }
  }

  /// The scene that is shown, else the first; without any, every node that has no parent. No node has two parents.
  void read_scene() {
    if (error_) return;
    std::vector<bool> has_parent(file_.nodes.size(), false);
    for (const GltfNode& node : file_.nodes) {
      for (const std::size_t child : node.children) {
        if (has_parent[child])
          return fail_at("nodes", "nodes[" + std::to_string(child) + "] hangs on two others, or on one twice");
        has_parent[child] = true;
      }
    }
    const std::size_t shown = index(root_, "scene", "scenes").value_or(0), scenes = count_in("scenes");
    if (scenes > 1)
      file_.notes.add("", "of " + std::to_string(scenes) + " scenes, scenes[" + std::to_string(shown) + "] is read");
    if (scenes > 0) {
      file_.roots = indices(root_["scenes"][shown], "nodes", "nodes");
      for (const std::size_t root : file_.roots) {
        if (error_) return;
        if (has_parent[root]) return fail_at("scenes", "nodes[" + std::to_string(root) + "] hangs on another, or is there twice");
        has_parent[root] = true;
      }
      return;
    }
    for (std::size_t i = 0; i < has_parent.size(); ++i)
      if (!has_parent[i]) file_.roots.push_back(i);
  }

  const Json& root_;
  std::string_view binary_;
  const std::string& folder_;
  GltfFile file_;
  std::vector<std::string_view> buffers_;
  std::size_t held_ = 0;
  std::optional<Diagnostic> error_;
  std::string array_;  // which item an error is in
  std::size_t item_ = 0;
};

}  // namespace

tl::expected<GltfFile, Diagnostic> parse_gltf(std::string bytes, const std::string& folder) {
  ReadNotes notes;
  std::list<std::string> whole;
  whole.push_back(std::move(bytes));
  TACTUS_TRY(const auto chunks, split_chunks(whole.front(), notes));
  TACTUS_TRY(const auto root, parse_json(chunks.json));
  auto file = GltfReader(root, chunks.binary, folder).read(std::move(notes));
  if (file && chunks.binary.data() != nullptr) file->held.splice(file->held.end(), whole);
  return file;
}

}  // namespace tactus::sim
