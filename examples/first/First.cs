// SPDX-License-Identifier: Apache-2.0
// The first program: a cube slides and comes to rest, one second at 1 kHz. It prints what the other programs of this folder print.
using System;
using System.Runtime.InteropServices;

public unsafe struct Pose { public fixed double position[3]; public fixed double rotation[4]; }
public unsafe struct Sample { public Pose pose; public fixed double velocity[3]; public fixed double angular[3]; }
public unsafe struct Truth { public uint size, reserved; public Sample* objects; public IntPtr count; public fixed ulong others[9]; }
public unsafe struct Packet { public byte* data; public uint bytes, substream; public long tick, number; public fixed uint others[6]; }
public unsafe struct Encoded { public uint size, reserved; public Packet* packets; public IntPtr count, held, heldCount; }
public struct Error { public int status, advice; public ulong bit; public IntPtr name, rule, text, remedy, concerns, detail; }

public static unsafe class First {  // functions and structs of tactus.h and tactus_encoder.h
  [DllImport("tactus")] static extern int tactus_scene_builder_create(void* options, out IntPtr builder, out Error e);
  [DllImport("tactus")] static extern int tactus_scene_builder_rigid(IntPtr builder, string name, void* options, out Error e);
  [DllImport("tactus")] static extern int tactus_scene_builder_build(IntPtr builder, out IntPtr scene, out Error e);
  [DllImport("tactus")] static extern int tactus_sender_create(IntPtr scene, void* options, out IntPtr sender, out Error e);
  [DllImport("tactus")] static extern int tactus_receiver_create(IntPtr scene, void* options, out IntPtr receiver, out Error e);
  [DllImport("tactus")] static extern int tactus_sender_encode(IntPtr sender, long tick, ref Truth truth, ref Encoded encoded, out Error e);
  [DllImport("tactus")] static extern int tactus_receiver_push(IntPtr to, long number, byte* data, IntPtr size, long now, void* info, out Error e);
  [DllImport("tactus")] static extern int tactus_receiver_poses(IntPtr of, long tick, int first, IntPtr count, out Pose poses, byte* levels, out Error e);
  static Error e;
  static void Check(int status) { if (status != 0) throw new Exception(Marshal.PtrToStringAnsi(e.text)); }

  public static void Main() {
    Check(tactus_scene_builder_create(null, out IntPtr builder, out e));
    Check(tactus_scene_builder_rigid(builder, "cube", null, out e));
    Check(tactus_scene_builder_build(builder, out IntPtr scene, out e));  // both ends declare the same
    Check(tactus_sender_create(scene, null, out IntPtr sender, out e));
    Check(tactus_receiver_create(scene, null, out IntPtr receiver, out e));
    uint count = 0, bytes = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      double t = Math.Min(tick, 500) / 1000.0;  // s; at rest from 0.5 s on
      var cube = new Sample();
      cube.pose.position[0] = 0.2 * t - 0.2 * t * t;  // m
      cube.pose.rotation[0] = 1;                      // w
      cube.velocity[0] = 0.2 - 0.4 * t;               // m/s
      var truth = new Truth {size = (uint)sizeof(Truth), objects = &cube, count = (IntPtr)1};
      var encoded = new Encoded {size = (uint)sizeof(Encoded)};
      Check(tactus_sender_encode(sender, tick, ref truth, ref encoded, out e));
      for (Packet* p = encoded.packets; p < encoded.packets + (int)encoded.count; ++p) {  // mostly none: the receiver predicts
        Console.WriteLine($"tick {tick}: {p->bytes} bytes");
        count += 1; bytes += p->bytes;
        Check(tactus_receiver_push(receiver, p->number, p->data, (IntPtr)p->bytes, long.MinValue, null, out e));  // a network would be here
      }
    }
    Check(tactus_receiver_poses(receiver, 999, 0, (IntPtr)1, out Pose shown, null, out e));
    double x = shown.position[0], y = shown.position[1], z = shown.position[2];
    Console.WriteLine(FormattableString.Invariant($"{count} packets, {bytes} bytes; shown at tick 999: x {x:F4} m, y {y:F4} m, z {z:F4} m"));
  }
}
