// SPDX-License-Identifier: Apache-2.0
/// Scenes, packets and streams of tactus::codec; <tactus/session.h> has sessions over a network. A Sender turns true states into packets; a
/// Receiver turns packets into what a client shows:
///
///   #include <cstdio>
///   #include <tactus/tactus.h>
///
///   int main() {
///     const auto scene = tactus::SceneBuilder().rigid("cube").build();  // both ends declare the same scene
///     if (!scene) return 1;
///     auto sender = tactus::Sender::create(*scene);
///     auto receiver = tactus::Receiver::create(*scene);
///     if (!sender || !receiver) return 1;
///     for (int tick = 0; tick < 1000; ++tick) {  // a second at 1 kHz
///       const tactus::RigidSample cube{.pose = {{1e-4 * tick, 0, 0}, {}}, .velocity = {0.1, 0, 0}, .angular_velocity = {}};
///       const auto packets = sender->encode(tick, {.objects = {&cube, 1}});
///       if (!packets) return 1;
///       for (const tactus::Packet& packet : *packets)      // mostly none: the receiver predicts
///         if (!receiver->push(packet.number, packet.bytes)) return 1;     // this is where a network would be
///     }
///     const tactus::Pose shown = receiver->pose(0, 999);
///     std::printf("the client shows x = %.3f m\n", shown.position.x);
///   }
///
/// Integers that are equal at every client are in receiver->replica(). examples/ continues with losses, sessions, deformable objects and traces.
///
/// These headers are the interface, beside those of session.h:
///   sender.h, receiver.h, player.h      true states to packets, packets to what is shown, a stream file tick by tick
///   scene/scene_builder.h, scene.h      what both ends declare; scene_syntax.h: as bytes
///   file/stream_file.h                  packets in a file
///   client/replica.h                    what is shown in integers, levels of detail; stiffness_reduction.h: forces that come late
///   deformable/motion_clusters.h        a basis for a mesh, found on a recording
///   base/geometry.h, result.h           vectors and rotations; errors
/// The other ones that are installed are there because these include them: they may change in any version.
///
/// Errors are values: every function that can fail returns a Result, whose Error names a class and a rule of the specification.
/// describe() explains it, remedy() suggests a fix, advice() says how a receiver should react. Nothing throws but std::bad_alloc,
/// from SceneBuilder and from writing files. After create() a Sender, Receiver and Player allocate nothing. Threads: a Scene never
/// changes and may be shared; any other object is used by one thread at a time. Spans are valid until the next call of the object that
/// returned them, unless its header says otherwise.
#pragma once

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/client/replica.h>
#include <tactus/client/stiffness_reduction.h>
#include <tactus/deformable/motion_clusters.h>
#include <tactus/file/stream_file.h>
#include <tactus/player.h>
#include <tactus/receiver.h>
#include <tactus/scene/scene.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/sender.h>
