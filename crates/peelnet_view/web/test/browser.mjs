// The page in headless Chromium. PEELNET_CHROMIUM is its path, else the usual ones are tried; PEELNET_PAGE is the folder of the page, else out/web.

import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { dirname, extname, join, normalize, sep } from 'node:path';
import { fileURLToPath } from 'node:url';
import puppeteer from 'puppeteer-core';

export const ROOT = normalize(join(dirname(fileURLToPath(import.meta.url)), '../../../..'));
const PAGE = normalize(process.env.PEELNET_PAGE ?? join(ROOT, 'out/web'));
/** Pictures of native drawings and of the page. */
export const OUT = join(ROOT, 'out/view-test');

const USUAL = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome', '/Applications/Google Chrome.app/Contents/MacOS/Google Chrome', 'C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe'];

// Software drawing, the same on machines with and without a graphics card. Without these WebGPU has no adapter when headless, or no canvas.
const FLAGS = ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=swiftshader', '--disable-vulkan-surface', '--enable-unsafe-swiftshader', '--no-sandbox'];

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm', '.png': 'image/png' };

/** How long something may take: machines that test are slow and busy. */
export const PATIENCE = 180_000;

/** Serves the page, and below /out/ the pictures of native drawings, on a free port of this machine. */
async function serve() {
  if (!existsSync(join(PAGE, 'index.html'))) throw new Error(`${PAGE} has no page: cargo xtask web builds it`);
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://x').pathname);
    const [root, rest] = path.startsWith('/out/') ? [OUT, path.slice(4)] : [PAGE, path === '/' ? '/index.html' : path];
    const file = normalize(join(root, rest));
    try {
      if (!file.startsWith(root + sep)) throw new Error('outside');
      const bytes = readFileSync(file);
      response.setHeader('content-type', TYPES[extname(file)] ?? 'application/octet-stream');
      response.setHeader('content-length', bytes.length);
      response.end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise(done => server.listen(0, '127.0.0.1', done));
  return { url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}

/** A browser; `page` opens the viewer in a fresh tab. */
export async function open() {
  mkdirSync(OUT, { recursive: true });
  const path = process.env.PEELNET_CHROMIUM ?? USUAL.find(existsSync);
  if (!path) throw new Error('The tests need Chromium: install it (Debian: apt-get install chromium), or set PEELNET_CHROMIUM to the path of Chromium or Chrome.');
  const server = await serve();
  const browser = await puppeteer.launch({ executablePath: path, args: FLAGS, protocolTimeout: 600_000 });
  return {
    browser,
    page: (query, options) => viewer(browser, server.url, query, options),
    async close() {
      await browser.close();
      server.close();
    }
  };
}

async function viewer(browser, url, query, { width = 320, height = 240, scale = 1, dark = false, before, waits = true } = {}) {
  const tab = await browser.newPage();
  const said = [];
  tab.on('console', message => said.push(`${message.type()}: ${message.text()}`));
  tab.on('pageerror', error => said.push(`error: ${error}`));
  await tab.setViewport({ width, height, deviceScaleFactor: scale });
  await tab.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }]);
  if (before) await tab.evaluateOnNewDocument(before);
  await tab.goto(url + query);
  const page = {
    tab,
    said,
    /** What went wrong, by the console. */
    errors: () => said.filter(line => /^error|^warn|panicked/.test(line)),
    /** Calls a function of the viewer. */
    call: (name, ...args) => tab.evaluate((n, a) => window.peelnet.page[n](...a), name, args),
    /** Waits until the view is drawn whole. */
    whole: () => tab.waitForFunction('window.peelnet?.page.is_whole()', { timeout: PATIENCE, polling: 50 }),
    /** Waits until a line of the messages has this in it. */
    message: text => tab.waitForFunction(t => window.peelnet.page.messages().includes(t), { timeout: PATIENCE, polling: 50 }, text),
    /** Draws with another method, and waits for its picture. */
    async method(name) {
      const frames = await page.call('frames');
      await page.call('set_method', name);
      await tab.waitForFunction(n => window.peelnet.page.frames() > n && window.peelnet.page.is_whole(), { timeout: PATIENCE, polling: 50 }, frames);
      await page.frames(3);
    },
    /** Waits for frames of the browser: what one draws, a later one shows. */
    frames: count => tab.evaluate(async n => {
      for (let i = 0; i < n; i++) await new Promise(requestAnimationFrame);
    }, count),
    /** Drops files, `{ name: text or base64 }`, onto the canvas. */
    drop: files => tab.evaluate(all => {
      const data = new DataTransfer();
      for (const [name, content] of Object.entries(all)) {
        const bytes = Uint8Array.from(atob(content), c => c.charCodeAt(0));
        data.items.add(new File([bytes], name));
      }
      document.getElementById('canvas').dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
    }, Object.fromEntries(Object.entries(files).map(([name, content]) => [name, Buffer.from(content).toString('base64')]))),
    /** What the canvas shows, as the data address of a PNG file. Screenshots of headless browsers have no WebGPU in them. */
    shown: () => tab.evaluate(() => new Promise(done => requestAnimationFrame(() => done(document.getElementById('canvas').toDataURL())))),
    /** The same in a file. */
    async save(name) {
      const data = await page.shown();
      writeFileSync(join(OUT, name), Buffer.from(data.split(',')[1], 'base64'));
      return data;
    },
    /** Differences of what the canvas shows from a picture, given by its address, of 255. */
    differences: async picture => tab.evaluate(async (shown, other) => {
      const pixels = async address => {
        const bitmap = await createImageBitmap(await (await fetch(address)).blob());
        const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
        context.drawImage(bitmap, 0, 0);
        return context.getImageData(0, 0, bitmap.width, bitmap.height);
      };
      const [a, b] = [await pixels(shown), await pixels(other)];
      if (a.width !== b.width || a.height !== b.height) throw new Error(`${a.width}x${a.height} and ${b.width}x${b.height}`);
      let [most, sum, beyond] = [0, 0, 0];
      for (let i = 0; i < a.data.length; i += 4) {
        const d = Math.max(...[0, 1, 2].map(k => Math.abs(a.data[i + k] - b.data[i + k])));
        [most, sum, beyond] = [Math.max(most, d), sum + d, beyond + (d > 1)];
      }
      return { most, mean: sum / (a.data.length / 4), beyond: beyond / (a.data.length / 4) };
    }, await page.shown(), picture),
    close: () => tab.close()
  };
  if (waits) await page.whole();
  return page;
}
