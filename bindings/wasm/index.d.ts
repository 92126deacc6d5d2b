// SPDX-License-Identifier: Apache-2.0
/** The decoder of Tactus, a codec for shared haptic virtual environments. SI units, right-handed world frame, quaternions w x y z,
    time in integer ticks of the scene. Functions throw a TactusError when the input breaks a rule. */
export {constants} from "./interface.js";

export type Reason = "request" | "heartbeat" | "visual" | "haptic";
export type Interpolation = "none" | "linear" | "hermite" | "blending" | "playout";

export class TactusError extends Error {
  readonly status: number;
  readonly errorClass: string;  // "malformed"
  readonly rule: string;        // "R-STR-4": of the specification
  readonly bitOffset: bigint;   // position in the input
  readonly remedy: string;      // may be empty
  readonly advice: "none" | "drop" | "request key" | "close";
}

/** What a decoder accepts; left out: defaults. */
export interface Limits {
  objects?: number;
  header_bytes?: number;
  packet_bytes?: number;
  vertices?: number;
  triangles?: number;
  state_bytes?: bigint;
  basis_work?: bigint;
}

export interface Options {
  interpolation?: Interpolation;
  limits?: Limits;
}

export interface Packet {
  readonly tick: number;
  readonly number: number;     // as push() was told; of a file: counted in its substream, or as the record says
  readonly bytes: number;      // of a file's packet, else 0
  readonly offset: number;     // in the file, else 0
  readonly substream: number;  // 0: rigid objects; i + 1: deformable object i; the next: loads
  readonly kind: "rigid" | "deformable" | "load";
  readonly key: boolean;       // builds on the initial state
  readonly layer: "haptic" | "visual" | "all";
  readonly reason: Reason;     // rigid objects: strongest among the updates
  readonly updates: number;    // objects named, or vertices with a residual of their own
}

export interface Pose {
  readonly position: readonly [number, number, number];          // m
  readonly rotation: readonly [number, number, number, number];  // w x y z, object to world
}

export interface RigidBounds {
  readonly haptic: "off" | "isotropic" | "cone" | "fixed" | "perceptual";
  readonly heartbeat: number;         // s, 0: off
  readonly visualPosition: number;    // m
  readonly visualRotation: number;    // rad
  readonly weberFraction: number;
  readonly perceptualFraction: number;
  readonly coneAngle: number;         // rad
  readonly fixedPosition: number;     // m
  readonly fixedRotation: number;     // rad
  readonly forceFloor: number;        // N
}

export interface DeformableBounds {
  readonly visual: number;                // m
  readonly weberFraction: number | null;  // null: no haptic bound
  readonly depthFloor: number;            // m
  readonly kept: boolean;                 // false: the stream aims at its bounds
}

/** What there is, in the order of the stream. */
export class Scene {
  private constructor();
  readonly tickRate: number;      // per second
  readonly substreams: number;
  readonly positionExp: number;   // positions are multiples of 2^-positionExp m
  readonly smoothed: boolean;
  readonly loadUsers: number | null;
  readonly bytes: number | null;  // that parseScene took
  readonly rigid: readonly {readonly name: string; readonly dof: number; readonly initial: Pose}[];
  readonly deformables: readonly {
    readonly name: string; readonly vertices: number; readonly triangles: number; readonly modes: number;
    readonly profile: "thesis" | "main"; readonly layered: boolean; readonly framePeriod: number;
    readonly clusters: number;    // of vertices that move alike; 0: none
  }[];
  /** Vertices at rest, V x 3, m. */
  rest(deformable: number): Float32Array;
  /** Corners, T x 3, counter-clockwise seen from outside. */
  triangles(deformable: number): Uint32Array;
  /** Of each vertex, N/m, infinite where it does not move; null: not declared. */
  stiffness(deformable: number): Float64Array | null;
  readonly rigidBounds: RigidBounds | null;
  deformableBounds(deformable: number): DeformableBounds | null;
  /** A scene of parseScene; those of receivers and players go with them. What is closed throws. */
  close(): void;
}

/** Packets in, replica out. */
export class Receiver {
  private constructor();
  readonly scene: Scene;
  /** Decode a packet. Its number is not in its bytes: send both. A sender that restarts counts anew, so its packets go to a new receiver.
      in  number  as the sender gave it: above 0, at most Number.MAX_SAFE_INTEGER
          now     the client's tick at which the replica applies it; left out: the packet's own */
  push(number: number, packet: Uint8Array, now?: number | null): Packet;
  /** This number came, and no packet of rigid objects has it: with "playout" the replica need not interpolate over it. */
  skipNumber(number: number): void;
  /** Objects that the packet decoded last named. */
  updates(): {object: number; reason: Reason; level: number}[];
  /** Poses of all rigid objects as shown at a tick: x y z (m), w x y z of each. */
  poses(tick: number, out?: Float64Array): Float64Array;
  /** Displacements from rest as shown at a tick, V x 3, m. */
  displacements(deformable: number, tick: number, out?: Float32Array): Float32Array;
  /** Forces on a rigid object (N): external, hold, then one per user, x y z each; null: the scene sends none of it. */
  loads(object: number, tick: number): Float64Array | null;
  /** 16 hexadecimal digits; equals that of the sender. */
  stateHash(substream: number): string;
  poseHash(tick: number): string;
  close(): void;
}

/** A stream file, tick by tick. */
export class Player {
  private constructor();
  readonly scene: Scene;
  readonly receiver: Receiver;
  /** Apply the next packet that is due at a tick; null when none is. Call it until then. */
  play(tick: number): Packet | null;
  /** Tick of the next packet; null at the end. */
  nextTick(): number | null;
  readonly headerBytes: number;
  readonly complete: boolean;  // the file has its end; valid after the last packet
  close(): void;
}

export interface Tactus {
  readonly version: string;
  openPlayer(file: Uint8Array, options?: Options): Player;
  /** The scene declaration at the front of some bytes. */
  parseScene(bytes: Uint8Array, limits?: Limits): Scene;
  createReceiver(scene: Scene, options?: Options): Receiver;
}

/** Instantiate the module.   in  source  bytes, a compiled module or an address; left out: tactus.wasm beside this file */
export function load(source?: BufferSource | WebAssembly.Module | URL): Promise<Tactus>;
