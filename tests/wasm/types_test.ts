// SPDX-License-Identifier: Apache-2.0
// Compiles only if the declarations say what they should.
import {constants, load, Player, Reason, TactusError} from "@tactus-codec/decoder";

export async function reasons(file: Uint8Array): Promise<Map<Reason, number>> {
  const tactus = await load();
  const counts = new Map<Reason, number>();
  try {
    const player: Player = tactus.openPlayer(file, {interpolation: "linear", limits: {vertices: 1000}});
    for (let tick = player.nextTick(); tick !== null; tick = player.nextTick()) {
      const reason = player.play(tick)?.reason;
      if (reason !== undefined) counts.set(reason, (counts.get(reason) ?? 0) + 1);
      const [x]: Float64Array = player.receiver.poses(tick);
      if (x === player.scene.rigidBounds?.visualPosition) player.close();
    }
    // @ts-expect-error there is no such interpolation
    tactus.openPlayer(file, {interpolation: "cubic"});
  } catch (error) {
    if (error instanceof TactusError && error.status !== constants.TACTUS_CHECKSUM) console.error(error.rule, error.advice);
  }
  return counts;
}
