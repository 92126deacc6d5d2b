// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/box_tree.h>

#include <algorithm>
#include <utility>

namespace tactus::sim {

void BoxTree::reserve(std::size_t count) {
  items_.reserve(count);
  nodes_.reserve(count + 1);  // a leaf holds at least two, unless it is the root
}

void BoxTree::build() {
  nodes_.clear();
  if (!items_.empty()) split(0, static_cast<std::uint32_t>(items_.size()));
}

void BoxTree::split(std::uint32_t first, std::uint32_t last) {
  Extent around = items_[first].bounds;
  for (std::uint32_t i = first + 1; i < last; ++i) {
    const Extent& box = items_[i].bounds;
    around.low = {std::min(around.low.x, box.low.x), std::min(around.low.y, box.low.y), std::min(around.low.z, box.low.z)};
    around.high = {std::max(around.high.x, box.high.x), std::max(around.high.y, box.high.y), std::max(around.high.z, box.high.z)};
  }
  const std::size_t node = nodes_.size();
  nodes_.push_back({around, first, last - first, node + 1});
  if (last - first <= kLeafSize) return;
  const Vec3 size = around.high - around.low;
  double Vec3::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3::x : size.y >= size.z ? &Vec3::y : &Vec3::z;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(items_.begin() + first, items_.begin() + middle, items_.begin() + last, [axis](const Item& a, const Item& b) {
    return std::pair(a.bounds.low.*axis + a.bounds.high.*axis, a.number) <
           std::pair(b.bounds.low.*axis + b.bounds.high.*axis, b.number);
  });
  nodes_[node].count = 0;
  split(first, middle);
  split(middle, last);
  nodes_[node].skip = nodes_.size();
}

}  // namespace tactus::sim
