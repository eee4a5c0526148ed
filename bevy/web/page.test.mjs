// The page in Chromium, on a software rasteriser: `PEELNET_PAGE=FOLDER node --test web/page.test.mjs`, where the folder has index.html, page.js and
// page_bg.wasm.gz. README.md says how they come there.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { fileURLToPath } from 'node:url';
import { open } from '../../packages/three/test/browser.mjs';

const FOLDER = process.env.PEELNET_PAGE ?? fileURLToPath(new URL('../../out/page', import.meta.url));

/** Errors of 255 up to which a picture is the exact one: a half more than outside browsers (0.36 to 0.45), of which rounding to 8 bits is 0.3. */
const MOST = 0.65;
/** The network of one pass errs by 1.9 outside browsers. */
const MOST_OF_ONE = 2.5;
/** Chromium's software rasteriser, SwiftShader, gives all samples of a pixel one depth (`position.z`), against Vulkan's rules. Sorted, it is 8.3. */
const MOST_OF_SAMPLES = 2.5;
/** What Bevy's sorting exceeds: else the scene would prove nothing. */
const LEAST_OF_SORTED = 5;
/** Without its transparent cards the picture is farther off than this. */
const DRAWN = 12;

// One browser for all: another one started by the same process loses its device (Chromium 148 with SwiftShader).
let browser;
before(async () => { browser = await open({ root: FOLDER }); });
after(() => browser.close());

/** Looks at the page until its error of 255 is at most this, or a minute is over. Then nothing may have been said but information. */
async function errorOf(network, samples, most) {
  const { page, said, server } = browser;
  said.length = 0;
  await page.goto(`${server.url}/index.html?network=${network}&samples=${samples}`);
  await page.waitForFunction('window.ready === true', { timeout: 60_000 });
  const end = Date.now() + 60_000;
  let found;
  do {
    await setTimeout(500);
    found = await page.evaluate(() => window.error());
  } while (found.rmse > most && Date.now() < end);
  // Bevy's log is in the console as `log:`, whatever its level. Its own warnings are about the rasteriser.
  const wrong = said.filter(text => !/^(log|info|debug):/.test(text) || /%cERROR|peelnet/.test(text));
  assert.deepEqual(wrong, []);
  assert.deepEqual(found.size, [256, 192]);
  console.log(`${network || 'sorted'}, ${samples} samples a pixel: ${found.rmse.toFixed(3)}`);
  return found.rmse;
}

for (const [network, samples, most] of [
  ['small', 1, MOST],
  ['medium', 1, MOST],
  ['large', 1, MOST],
  ['one', 1, MOST_OF_ONE],
  ['medium', 4, MOST_OF_SAMPLES]
]) {
  test(`${network}, ${samples} samples a pixel: the exact picture`, async () => {
    const rmse = await errorOf(network, samples, most);
    assert.ok(rmse <= most, `${rmse}`);
  });
}

test('sorting gets the scene wrong', async () => {
  const rmse = await errorOf('', 1, DRAWN);
  assert.ok(rmse > LEAST_OF_SORTED, `${rmse}`);
});
