// The viewer's page in headless Chromium, against pictures of `peelnet render`.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { OUT, PATIENCE, ROOT, open } from './browser.mjs';
import { AMONG, OBJ, cloud, square } from './files.mjs';

const BINARY = process.env.PEELNET_BINARY ?? join(ROOT, 'target/release/peelnet');
const METHODS = ['abuffer', 'depth-peel', 'mboit4', 'deep-medium'];
const VIEW = '?scene=cups&view=1&bare=1&method=';

// Both draw the same, on two software rasterisers: SwiftShader in Chromium, Mesa's lavapipe natively. They round the places of vertices and of
// edges differently, so a few pixels beside edges have another fragment: those are counted. All others are within a step of 255.
const BESIDE_EDGES = 0.005;
// Mean difference, steps: far below the rounding to whole ones.
const MEAN = 0.1;
// The same where a pixel's forty layers are added up in half floats, which SwiftShader rounds to nearest and lavapipe towards zero: half a step of
// 2^-11 each, 2.5 steps of 255 together at most. Colours and weights err alike, and their quotient by far less: a fifth of that on average.
const MEAN_OF_SUMS = 0.5;
// And the pixels where it is more than a step, those beside edges among them.
const BEYOND_OF_SUMS = 0.02;

// What an allocator's free lists may still grow by, MiB: 4 KiB a frame left behind in 1000 frames would be more.
const FRAGMENTS = 2;

let browser;

before(async () => browser = await open());
after(() => browser?.close());

const draws = (method, name, scene = 'cups', view = '1') => {
  const path = join(OUT, name);
  execFileSync(BINARY, ['render', scene, '--quiet', '--force', '--view', view, '--size', '320x240', '--method', method, '--out', path], { stdio: 'inherit' });
  return `/out/${name}`;
};

test('loads, and shows that it does', async () => {
  const page = await browser.page('?bare=1', { waits: false });
  const told = await page.tab.evaluate(() => document.getElementById('say').textContent);
  await page.whole();
  const { ms, bytes } = await page.tab.evaluate(() => ({
    ms: performance.now(),
    bytes: performance.getEntriesByType('resource').reduce((sum, r) => sum + r.encodedBodySize, 0)
  }));
  console.log(`    first picture after ${(ms / 1000).toFixed(2)} s, ${(bytes / 1e6).toFixed(2)} MB as they are; said meanwhile: ${told}`);
  assert.equal(await page.tab.evaluate(() => document.getElementById('say').textContent), '');
  assert.equal(await page.call('scene'), 'cups');
  assert.deepEqual(page.errors(), []);
  await page.close();
});

test('draws what peelnet render draws', async () => {
  const page = await browser.page(VIEW + 'wboit-eq9');
  for (const method of METHODS) {
    const native = draws(method, `native-${method}.png`);
    await page.method(method);
    await page.save(`page-${method}.png`);
    const { most, mean, beyond } = await page.differences(native);
    console.log(`    ${method}: mean ${mean.toFixed(4)}/255, ${(100 * beyond).toFixed(3)} % of the pixels differ by more than 1, at most ${most}`);
    assert.ok(mean <= MEAN, `${method}: ${mean}`);
    assert.ok(beyond <= BESIDE_EDGES, `${method}: ${beyond}`);
  }
  assert.equal(await page.call('messages'), '');
  assert.deepEqual(page.errors(), []);
  await page.close();
});

test('the error of the view is measured', async () => {
  const page = await browser.page(VIEW + 'mboit4');
  await page.tab.waitForFunction('window.peelnet.page.error() !== undefined', { timeout: PATIENCE });
  const error = await page.call('error');
  assert.ok(error > 0 && error < 1000, `${error}`);
  await page.method('abuffer');
  await page.tab.waitForFunction('window.peelnet.page.error() === 0', { timeout: PATIENCE });
  assert.deepEqual(page.errors(), []);
  await page.close();
});

test('the address shows the same view again', async () => {
  const page = await browser.page('?scene=panes&bare=1&method=mboit4');
  await page.call('orbit', 0.3, 0.1);
  await page.method('deep-small');
  await page.tab.waitForFunction(() => location.search.includes('deep-small') && location.search.includes('camera='), { timeout: PATIENCE });
  const [query, shown] = [await page.tab.evaluate(() => location.search), await page.shown()];
  await page.close();
  const again = await browser.page(query);
  await again.frames(3);
  assert.deepEqual([await again.call('scene'), await again.call('method')], ['panes', 'deep-small']);
  const { most } = await again.differences(shown);
  assert.equal(most, 0);
  // Wrong words are said, and the rest counts.
  const wrong = await browser.page('?scene=nothing.glb&method=nonsense&view=7');
  const messages = await wrong.call('messages');
  for (const text of ['nothing.glb', 'drop it again', 'method=nonsense']) assert.ok(messages.includes(text), messages);
  assert.deepEqual([...again.errors(), ...wrong.errors()], []);
  await again.close();
  await wrong.close();
});

test('the last scene is kept', async () => {
  const page = await browser.page('?scene=panes');
  await page.call('open_scene', 'boxes');
  await page.whole();
  await page.tab.waitForFunction(() => localStorage.getItem('recent')?.startsWith('boxes'), { timeout: PATIENCE });
  await page.close();
  const again = await browser.page('?bare=1');
  assert.equal(await again.call('scene'), 'boxes');
  await again.tab.evaluate(() => localStorage.clear());
  await again.close();
});

test('dropped files open; what is none leaves the view as it is', async () => {
  const page = await browser.page(VIEW + 'abuffer');
  await page.drop({ 'square.glb': square() });
  await page.tab.waitForFunction("window.peelnet.page.scene() === 'square.glb' && window.peelnet.page.is_whole()", { timeout: PATIENCE });
  await page.frames(3);
  const shown = await page.save('dropped.png');
  assert.match(await page.call('messages'), /^square.glb: has no point light[^\n]*$/);
  const model = readFileSync(join(ROOT, 'models/small/model.safetensors'));
  const other = Buffer.from(model.toString('latin1').replace(/(format_version\D{0,8})\d/, '$19'), 'latin1');
  assert.notDeepEqual(model, other, 'the file names its version');
  const bad = [
    [{ 'notes.txt': 'nothing' }, 'notes.txt: not a scene or a network'],
    [{ 'broken.glb': 'glTF nothing' }, 'broken.glb'],
    [{ 'scene.toml': 'what = [' }, 'scene.toml'],
    [{ 'broken.safetensors': 'nothing' }, 'broken.safetensors'],
    [{ 'other.safetensors': other }, 'other.safetensors']
  ];
  for (const [files, text] of bad) {
    await page.drop(files);
    await page.message(text);
    console.log(`    ${(await page.call('messages')).split('\n').at(-1)}`);
    assert.equal(await page.call('scene'), 'square.glb');
    await page.frames(2);
    assert.equal((await page.differences(shown)).most, 0, text);
  }
  // More than a page opens: 600 MiB, of one block again and again.
  await page.tab.evaluate(() => {
    const data = new DataTransfer();
    data.items.add(new File(Array(75).fill(new Uint8Array(8 << 20)), 'huge.glb'));
    document.getElementById('canvas').dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
  });
  await page.message('600 MiB were dropped');
  assert.equal(await page.call('scene'), 'square.glb');
  // Without its materials a mesh still opens, and the file that was not dropped is named.
  await page.drop({ 'alone.obj': OBJ });
  await page.tab.waitForFunction("window.peelnet.page.scene() === 'alone.obj'", { timeout: PATIENCE });
  await page.message('square.mtl');
  await page.method('deep-small');
  await page.drop({ 'own.safetensors': model });
  await page.whole();
  assert.deepEqual(page.errors(), []);
  await page.close();
});

test('dropped splats, and panes among them, are what peelnet render draws', async () => {
  const page = await browser.page(VIEW + 'wboit-eq9');
  const files = { 'cloud.splat': cloud(), 'among.toml': AMONG };
  for (const [name, content] of Object.entries(files)) writeFileSync(join(OUT, name), content);
  for (const [name, dropped] of [['cloud.splat', { 'cloud.splat': cloud() }], ['among.toml', files]]) {
    await page.drop(dropped);
    await page.tab.waitForFunction(n => window.peelnet.page.scene() === n && window.peelnet.page.is_whole(), { timeout: PATIENCE }, name);
    for (const method of ['abuffer', 'splat', 'painter-triangle']) {
      const native = draws(method, `native-${name}-${method}.png`, join(OUT, name), '0');
      await page.method(method);
      await page.save(`page-${name}-${method}.png`);
      const { most, mean, beyond } = await page.differences(native);
      console.log(`    ${name}, ${method}: mean ${mean.toFixed(4)}/255, ${(100 * beyond).toFixed(3)} % of the pixels differ by more than 1, at most ${most}`);
      const [most_mean, most_beyond] = method === 'abuffer' ? [MEAN, BESIDE_EDGES] : [MEAN_OF_SUMS, BEYOND_OF_SUMS];
      assert.ok(mean <= most_mean, `${name}, ${method}: ${mean}`);
      assert.ok(beyond <= most_beyond, `${name}, ${method}: ${beyond}`);
    }
  }
  await page.tab.evaluate(() => localStorage.clear());
  assert.deepEqual(page.errors(), []);
  await page.close();
});

test('the scene that was dropped last is kept', async () => {
  const page = await browser.page('?bare=1&method=abuffer');
  const dropped = async name => {
    await page.drop({ [name]: square() });
    await page.tab.waitForFunction(n => window.peelnet.page.scene() === n && window.peelnet.page.is_whole(), { timeout: PATIENCE }, name);
    // The browser has it.
    await page.tab.waitForFunction(n => new Promise(done => {
      const opening = indexedDB.open('peelnet', 1);
      opening.onsuccess = () => {
        const get = opening.result.transaction('dropped').objectStore('dropped').get('last');
        get.onsuccess = () => { opening.result.close(); done(get.result?.scene === n) };
      };
    }), { timeout: PATIENCE }, name);
  };
  await dropped('first.glb');
  await dropped('second.glb');
  await page.frames(3);
  const shown = await page.shown();
  await page.tab.waitForFunction(() => location.search.includes('second.glb') && localStorage.getItem('recent')?.startsWith('second.glb'), { timeout: PATIENCE });
  await page.tab.reload();
  await page.whole();
  await page.frames(3);
  assert.equal(await page.call('scene'), 'second.glb');
  assert.equal((await page.differences(shown)).most, 0);
  // A page without a name in its address shows it as well; the one before is gone, and that is said.
  const again = await browser.page('?bare=1');
  assert.equal(await again.call('scene'), 'second.glb');
  const gone = await browser.page('?scene=first.glb&bare=1');
  assert.match(await gone.call('messages'), /first\.glb: no scene of this name ships/);
  for (const tab of [page, again, gone]) {
    await tab.tab.evaluate(() => localStorage.clear());
    assert.deepEqual(tab.errors(), []);
    await tab.close();
  }
});

test('a lost device is replaced', async () => {
  const page = await browser.page(VIEW + 'mboit4');
  const frames = await page.call('frames');
  await page.call('orbit', 0.2, 0.1);
  await page.tab.waitForFunction(n => window.peelnet.page.frames() > n, { timeout: PATIENCE, polling: 50 }, frames);
  await page.frames(3);
  const shown = await page.shown();
  for (let i = 0; i < 2; i++) {
    await page.call('lose_device');
    await page.tab.waitForFunction(n => window.peelnet.page.devices_lost() === n && window.peelnet.page.is_whole(), { timeout: PATIENCE, polling: 50 }, i + 1);
    await page.message('was lost');
    await page.frames(3);
    assert.equal((await page.differences(shown)).most, 0);
    assert.deepEqual([await page.call('scene'), await page.call('method')], ['cups', 'mboit4']);
  }
  assert.equal(await page.tab.evaluate(() => document.getElementById('say').textContent), '');
  console.log(`    said: ${page.errors().join(' | ') || 'nothing'}`);
  await page.close();
});

test('memory does not grow', async () => {
  // Small: what a frame leaves behind does not depend on its size.
  const page = await browser.page('?scene=panes&bare=1&method=deep-medium', { width: 96, height: 64 });
  const session = await page.tab.createCDPSession();
  const system = await browser.browser.target().createCDPSession();
  const weigh = async () => {
    await page.frames(5);
    for (let i = 0; i < 3; i++) await session.send('HeapProfiler.collectGarbage');
    const wasm = await page.tab.evaluate(() => window.peelnet.memory.buffer.byteLength);
    const { JSHeapUsedSize: js } = await page.tab.metrics();
    const { processInfo } = await system.send('SystemInfo.getProcessInfo');
    const id = processInfo.find(p => p.type.toLowerCase() === 'gpu')?.id;
    let gpu = 0;
    try {
      gpu = 1024 * Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${id}/status`, 'utf8'))[1]);
    } catch {
      // Linux alone has this.
    }
    return { wasm: wasm / 2 ** 20, js: js / 2 ** 20, gpu: gpu / 2 ** 20 };
  };
  const orbits = count => page.tab.evaluate(async n => {
    const { page } = window.peelnet;
    for (let i = 0; i < n; i++) {
      const drawn = page.frames();
      page.orbit(0.01, 0);
      while (page.frames() === drawn) await new Promise(requestAnimationFrame);
    }
  }, count);
  const changes = async count => {
    const all = ['wboit-eq9', 'mboit4', 'deep-medium', 'abuffer', 'kbuffer-4'];
    for (let i = 0; i < count; i++) await page.method(all[i % all.length]);
  };
  const text = w => `wasm ${w.wasm.toFixed(1)}, JavaScript ${w.js.toFixed(1)}, GPU process ${w.gpu.toFixed(0)} MiB`;
  await changes(15);
  await orbits(200);
  const begin = await weigh();
  await orbits(1000);
  const orbited = await weigh();
  await changes(50);
  const end = await weigh();
  console.log(`    at first: ${text(begin)}; after 1000 frames: ${text(orbited)}; after 50 methods: ${text(end)}`);
  for (const now of [orbited, end]) {
    assert.ok(now.wasm - begin.wasm <= FRAGMENTS, 'wasm memory grows');
    assert.ok(now.js - begin.js <= 4, 'the heap of JavaScript grows');
    assert.ok(now.gpu <= 1.2 * begin.gpu + 32, 'memory of the GPU process grows');
  }
  assert.deepEqual(page.errors(), []);
  await page.close();
});

test('a browser without WebGPU is told what is missing', async () => {
  const before = () => Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined });
  const page = await browser.page('', { before, waits: false });
  await page.tab.waitForFunction(() => document.getElementById('say').textContent.includes('WebGPU, which this browser does not have'), { timeout: PATIENCE });
  assert.deepEqual(page.errors(), []);
  await page.close();
});

test('looks', async () => {
  for (const [name, options] of [
    ['light', { width: 1000, height: 640 }],
    ['dark', { width: 1000, height: 640, dark: true }],
    ['phone', { width: 390, height: 844, dark: true }],
  ]) {
    const page = await browser.page('?scene=cups&method=mboit4&view=1', options);
    // Once with all numbers: the exact image of so many pixels takes a software rasteriser long.
    if (!options.dark) await page.tab.waitForFunction('window.peelnet.page.error() !== undefined', { timeout: PATIENCE });
    await page.frames(3);
    await page.save(`look-${name}.png`);
    assert.deepEqual(page.errors(), []);
    await page.close();
  }
});
