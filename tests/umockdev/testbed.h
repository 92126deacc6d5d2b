// SPDX-License-Identifier: Apache-2.0
/// Devices of umockdev, answered for by this program: the system's libraries see them below /dev and /sys.
#pragma once

#include <gtest/gtest.h>
#include <umockdev.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <vector>

namespace tactus::testing {

inline std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    out.push_back("0123456789ABCDEF"[byte >> 4]);
    out.push_back("0123456789ABCDEF"[byte & 15]);
  }
  return out;
}

/// Skips without umockdev-wrapper. Calls come on a thread of umockdev's.
class Testbed : public ::testing::Test {
 protected:
  void SetUp() override {
    bed_ = umockdev_testbed_new();
    base_ = umockdev_ioctl_base_new();
    if (!umockdev_in_mock_environment()) GTEST_SKIP() << "not run by umockdev-wrapper";
    g_signal_connect(base_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
    g_signal_connect(base_, "handle-read", G_CALLBACK(on_read), this);
    g_signal_connect(base_, "client-vanished", G_CALLBACK(on_vanished), this);
  }
  void TearDown() override {
    if (!node_.empty()) umockdev_testbed_detach_ioctl(bed_, node_.c_str(), nullptr);
    g_object_unref(base_);
    g_object_unref(bed_);
  }

  void plug(const std::string& devices, const std::string& node) {
    ASSERT_TRUE(umockdev_testbed_add_from_string(bed_, devices.c_str(), nullptr));
    ASSERT_TRUE(umockdev_testbed_attach_ioctl(bed_, node.c_str(), base_, nullptr));
    node_ = node;
  }
  /// poll() looks at the terminal behind a node: with a byte in it, it says from now on that there is something to read.
  void make_readable() { ASSERT_EQ(write(umockdev_testbed_get_dev_fd(bed_, node_.c_str()), "\n", 1), 1); }

  virtual bool answer_ioctl(UMockdevIoctlClient* client, gulong request, UMockdevIoctlData* argument) = 0;
  virtual bool answer_read(UMockdevIoctlClient* client, UMockdevIoctlData* buffer) = 0;
  virtual void forget(UMockdevIoctlClient*) {}  ///< it closed the node, or ended

 private:
  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, Testbed* self) {
    return self->answer_ioctl(client, umockdev_ioctl_client_get_request(client), umockdev_ioctl_client_get_arg(client)) ? TRUE
                                                                                                                        : FALSE;
  }
  static gboolean on_read(UMockdevIoctlBase*, UMockdevIoctlClient* client, Testbed* self) {
    return self->answer_read(client, umockdev_ioctl_client_get_arg(client)) ? TRUE : FALSE;
  }
  static void on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, Testbed* self) { self->forget(client); }

  UMockdevTestbed* bed_ = nullptr;
  UMockdevIoctlBase* base_ = nullptr;
  std::string node_;
};

}  // namespace tactus::testing
