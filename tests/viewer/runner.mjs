// SPDX-License-Identifier: Apache-2.0
// Runs tests one after the other and tells how they went; `near` is what they share.
import assert from "node:assert/strict";

export async function runTests(tests, ...given) {
  for (const [name, test] of Object.entries(tests)) {
    const begin = Date.now();
    try {
      const note = await test(...given);
      console.log(`ok      ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s${note ? `, ${note}` : ""})`);
    } catch (error) {
      process.exitCode = 1;
      console.log(`FAILED  ${name}: ${error.stack}`);
    }
  }
}

export const near = (value, wanted, within) => assert.ok(Math.abs(value - wanted) <= within, `${value} is not within ${within} of ${wanted}`);
