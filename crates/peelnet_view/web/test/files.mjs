// Files that the tests drop.

/** A GLB file of one half transparent square. */
export function square() {
  const vertices = new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]);
  const indices = new Uint16Array([0, 1, 2, 0, 2, 3]);
  const json = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: 'square' }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [0.9, 0.2, 0.1, 0.5] }, alphaMode: 'BLEND', doubleSided: true }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 4, type: 'VEC3', min: [-1, -1, 0], max: [1, 1, 0] },
      { bufferView: 1, componentType: 5123, count: 6, type: 'SCALAR' }
    ],
    bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: 48 }, { buffer: 0, byteOffset: 48, byteLength: 12 }],
    buffers: [{ byteLength: 60 }]
  };
  const text = Buffer.from(JSON.stringify(json));
  const chunk = (kind, bytes, pad) => {
    const length = Math.ceil(bytes.length / 4) * 4;
    const out = Buffer.alloc(8 + length, pad);
    out.writeUInt32LE(length, 0);
    out.writeUInt32LE(kind, 4);
    bytes.copy(out, 8);
    return out;
  };
  const body = Buffer.concat([chunk(0x4e4f534a, text, 0x20), chunk(0x004e4942, Buffer.concat([Buffer.from(vertices.buffer), Buffer.from(indices.buffer)]), 0)]);
  const head = Buffer.alloc(12);
  head.writeUInt32LE(0x46546c67, 0);
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([head, body]);
}

/** A square as OBJ, with the materials of a file that is not there. */
export const OBJ = 'mtllib square.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3 4/4\n';

/** A `.splat` file: splats on turned rings, of which those of later rings lie within those before. */
export function cloud(count = 400) {
  const out = Buffer.alloc(32 * count);
  for (let i = 0; i < count; i++) {
    const [turn, height] = [2.4 * i, 1.6 * i / count - 0.8];
    const radius = 0.9 - 0.5 * (i % 5) / 5;
    const place = [radius * Math.cos(turn), height, radius * Math.sin(turn)];
    const size = [0.05 + 0.02 * (i % 3), 0.1, 0.06];
    [...place, ...size].forEach((value, k) => out.writeFloatLE(value, 32 * i + 4 * k));
    // Colour and opacity, then a quaternion, its real part first, of bytes about 128.
    const color = [40 + 200 * (i % 2), 60 + 40 * (i % 5), 240 - 200 * (i % 2), 60 + 30 * (i % 6)];
    const turned = [Math.cos(turn), 0.6 * Math.sin(turn), 0.8 * Math.sin(turn), 0];
    [...color, ...turned.map(q => Math.min(255, Math.round(128 + 128 * q)))].forEach((byte, k) => out.writeUInt8(byte, 32 * i + 24 + k));
  }
  return out;
}

/** A scene of that file with two panes that cross among its splats. */
export const AMONG = `
[camera]
position = [0.3, 0.4, 3.2]
target = [0.0, 0.0, 0.0]
fov_y = 40.0
near = 0.1
far = 20.0
[[object]]
mesh = "cloud.splat"
[[object]]
mesh = { shape = "quad", size = [2.0, 1.2] }
rotate = [0.0, 40.0, 0.0]
material = { color = [0.8, 0.1, 0.05], alpha = 0.5 }
[[object]]
mesh = { shape = "quad", size = [2.0, 1.2] }
rotate = [0.0, -35.0, 10.0]
material = { color = [0.05, 0.2, 0.8], alpha = 0.4 }
`;
