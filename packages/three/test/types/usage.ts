// What a user writes, checked by tsc against the package's types. The package is found by its own name.

import { PerspectiveCamera, RenderPipeline, Scene, WebGPURenderer } from 'three/webgpu';
import { type PeelnetModel, PeelnetPassNode, isOrderIndependent, modelProblem, peelnetPass } from '@peelnet/three';
import medium, { description } from '@peelnet/three/models/medium';

const renderer = new WebGPURenderer();
const scene = new Scene();
const node: PeelnetPassNode = peelnetPass( scene, new PerspectiveCamera(), { model: medium, range: 'frame', samples: 0 } );
const loaded: PeelnetModel = { description, wgsl: '', glsl: null };

new RenderPipeline( renderer, node ).render();
node.model = loaded;
node.depthRange = [ 1, 10 ];
node.getTextureNode( 'depth' );
node.dispose();

const problem: string | null = modelProblem( JSON.parse( '{}' ) );

console.log( problem, isOrderIndependent );

// @ts-expect-error a pass needs a model
peelnetPass( scene, new PerspectiveCamera(), {} );

// @ts-expect-error the range is one of two
node.range = 'tile';

// @ts-expect-error only the pass finds problems
node.problem = 'none';
