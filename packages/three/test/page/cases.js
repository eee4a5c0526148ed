// What the tests ask of a page, by name. Each returns numbers and texts; the tests judge them.

import * as THREE from 'three/webgpu';
import { pass } from 'three/tsl';
import { oitPass } from 'three/addons/tsl/display/OITPassNode.js';
import { peelnetPass } from '@peelnet/three';
import { HEIGHT, WIDTH, errors, frameTime, imageOf, makeRenderer, peeled } from './measure.js';
import * as scenes from './scenes.js';

const modelOf = async ( name ) => ( await import( `@peelnet/three/models/${ name }.js` ) ).default;

const aspect = WIDTH / HEIGHT;

/** Errors of three.js's two methods and of this one, on a scene. */
export async function compared( backend, { scene: name = 'fifty', camera: cameraName = 'perspective', models = [ 'medium' ], ranges = [ 'pixel' ] } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes[ name ]();
	const camera = scenes[ cameraName ]( aspect );
	const problems = [];
	const exact = await peeled( renderer, scene, camera );
	const result = { layers: exact.layers, problems };

	const measure = async ( key, node ) => {

		result[ key ] = errors( await imageOf( renderer, node ), exact.image );
		node.dispose();

	};

	await measure( 'sorted', pass( scene, camera ) );
	await measure( 'weighted', oitPass( scene, camera ) );

	for ( const model of models ) {

		for ( const range of ranges ) {

			await measure( `${ model }:${ range }`, peelnetPass( scene, camera, { model: await modelOf( model ), range, onProblem: ( message ) => problems.push( message ) } ) );

		}

	}

	renderer.dispose();

	return result;

}

export async function debug( backend, { frames = 3 } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.twoCards();
	const camera = scenes.perspective( aspect );
	const node = peelnetPass( scene, camera, { model: await modelOf( 'medium' ) } );
	const image = await imageOf( renderer, node, frames );
	const at = 4 * ( 110 * WIDTH + 160 );
	const r = { image: [ ...image.slice( at, at + 4 ) ], span: node._span.value.toArray(), kept: node._kept };
	for ( const p of node._stages.passes ) for ( const [ i, t ] of p.target.textures.entries() ) { const x = await renderer.readRenderTargetPixelsAsync( p.target, 0, 0, WIDTH, HEIGHT, i ); const n = x.length / WIDTH / HEIGHT; r[ t.name ] = [ ...x.slice( at / 4 * n, at / 4 * n + n ) ].map( v=> x instanceof Uint16Array ? THREE.DataUtils.fromHalfFloat( v ) : v ); }
	return r;

}
