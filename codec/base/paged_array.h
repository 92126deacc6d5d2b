// SPDX-License-Identifier: Apache-2.0
/// Arrays that share what they have in common. Internal to the library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

namespace tactus {

/// An array of fixed size whose copies share its pages until one of them is written to: a copy that differs in few places costs four
/// bytes a page. Threads: one at a time for all copies of an array.
template <class T>
class PagedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_aggregate_v<T> && alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

 public:
  static constexpr std::size_t kPage = 8;  ///< elements; of a smaller array all

  PagedArray() = default;
  /// Of make(0), make(1) and so on. There may be so many copies, itself among them; they allocate nothing when they are assigned to each
  /// other, and what no copy needs is never touched.   allocates
  template <class Make>
  PagedArray(std::size_t size, std::size_t copies, Make&& make) : size_(size) {
    const std::size_t length = (std::min)(kPage, size), pages = (size + kPage - 1) / kPage;
    pool_ = std::make_shared<Pool>(copies * pages, length);
    pages_.reserve(pages);
    for (std::size_t first = 0; first < size; first += kPage) {
      pages_.push_back(pool_->take());
      for (std::size_t i = 0; i < length; ++i) pool_->page(pages_.back())[i] = first + i < size ? make(first + i) : T{};
    }
  }

  PagedArray(const PagedArray& other) { *this = other; }
  PagedArray(PagedArray&& other) noexcept : PagedArray() { swap(other); }
  PagedArray& operator=(PagedArray&& other) noexcept {
    if (this == &other) return *this;
    swap(other);
    return *this;
  }
  /// time O(pages that differ), and 4 ns for 128 elements.   allocates only where this was no copy of the same array before
  PagedArray& operator=(const PagedArray& other) {
    if (this == &other) return *this;
    if (pool_ != other.pool_) {
      release();
      pool_ = other.pool_;
      pages_.assign(other.pages_.size(), Pool::kNone);
      size_ = other.size_;
    }
    for (std::size_t first = 0; first < pages_.size(); first += kBlock) {
      const std::size_t count = (std::min)(kBlock, pages_.size() - first);
      if (std::memcmp(&pages_[first], &other.pages_[first], count * sizeof(std::uint32_t)) != 0)
        take_pages(other, first, first + count);
    }
    return *this;
  }
  ~PagedArray() { release(); }

  std::size_t size() const noexcept { return size_; }
  const T& operator[](std::size_t i) const noexcept { return pool_->page(pages_[i / kPage])[i % kPage]; }
  /// time O(1), a page more where it was shared
  void set(std::size_t i, const T& value) noexcept {
    std::uint32_t& page = pages_[i / kPage];
    if (pool_->is_shared(page)) {
      const std::uint32_t own = pool_->take();
      std::copy_n(pool_->page(page), pool_->length(), pool_->page(own));
      pool_->drop(page);
      page = own;
    }
    pool_->page(page)[i % kPage] = value;
  }
  /// Pages that are in use by all copies.
  std::size_t pages_in_use() const noexcept { return pool_ ? pool_->in_use() : 0; }

 private:
  class Pool {
   public:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    Pool(std::size_t pages, std::size_t length)
        : length_(length), bytes_(std::make_unique_for_overwrite<Bytes>(pages * length * sizeof(T))) {
      holders_.reserve(pages);
      free_.reserve(pages);
    }
    std::size_t length() const noexcept { return length_; }
    T* page(std::uint32_t page) noexcept { return reinterpret_cast<T*>(bytes_.get()) + page * length_; }
    std::uint32_t take() noexcept {
      if (free_.empty()) {
        holders_.push_back(1);
        return static_cast<std::uint32_t>(holders_.size() - 1);
      }
      const std::uint32_t out = free_.back();
      free_.pop_back();
      holders_[out] = 1;
      return out;
    }
    void hold(std::uint32_t page) noexcept { ++holders_[page]; }
    void drop(std::uint32_t page) noexcept {
      if (page != kNone && --holders_[page] == 0) free_.push_back(page);
    }
    bool is_shared(std::uint32_t page) const noexcept { return holders_[page] > 1; }
    std::size_t in_use() const noexcept { return holders_.size() - free_.size(); }

   private:
    using Bytes = std::byte[];
    std::size_t length_;  // [elements] of a page
    std::unique_ptr<Bytes> bytes_;
    std::vector<std::uint32_t> holders_, free_;
  };

  void swap(PagedArray& other) noexcept {
    std::swap(pool_, other.pool_);
    std::swap(pages_, other.pages_);
    std::swap(size_, other.size_);
  }
  void take_pages(const PagedArray& other, std::size_t begin, std::size_t end) noexcept {
    for (std::size_t i = begin; i < end; ++i) {
      if (pages_[i] == other.pages_[i]) continue;
      pool_->hold(other.pages_[i]);
      pool_->drop(pages_[i]);
      pages_[i] = other.pages_[i];
    }
  }
  void release() noexcept {
    for (const std::uint32_t page : pages_) pool_->drop(page);
    pages_.clear();
  }

  static constexpr std::size_t kBlock = 16;  // pages that are compared at once: few differ
  std::shared_ptr<Pool> pool_;
  std::vector<std::uint32_t> pages_;
  std::size_t size_ = 0;
};

}  // namespace tactus
