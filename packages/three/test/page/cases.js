// What the tests ask of a page, by name. Each returns numbers and texts; the tests judge them.

import * as THREE from 'three/webgpu';
import { pass, renderOutput, screenUV, texture, vec2 } from 'three/tsl';
import { oitPass } from 'three/addons/tsl/display/OITPassNode.js';
import { peelnetPass } from '@peelnet/three';
import { aspect, drawn, modelOf } from './helpers.js';
import { HEIGHT, WIDTH, errors, frameTime, imageOf, makeRenderer, nextFrame, peeled } from './measure.js';
import * as scenes from './scenes.js';

const median = ( values ) => values.toSorted( ( a, b ) => a - b )[ Math.floor( values.length / 2 ) ];

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

/**
 * Times of the main thread alone, in milliseconds: of 20,000 instances that all move in every frame, and of a batch of 5,000. Medians of rounds in
 * which `pass()` and this pass take turns.
 */
export async function mainThread( backend, { model = 'medium', rounds = 15 } ) {

	const renderer = await makeRenderer( backend );
	const camera = scenes.perspective( aspect );
	const next = scenes.random( 5 );
	const matrix = new THREE.Matrix4();
	const place = ( set, count ) => {

		for ( let i = 0; i < count; i ++ ) set( i, matrix.makeTranslation( 4 * next() - 2, 3 * next() - 1.5, 4 * next() - 2 ) );

	};

	const material = new THREE.MeshBasicMaterial( { transparent: true, opacity: 0.3 } );
	const geometry = new THREE.PlaneGeometry( 0.02, 0.02 );
	const instanced = new THREE.InstancedMesh( geometry, material, 20_000 );
	const batched = new THREE.BatchedMesh( 5_000, 4, 6, material );
	const id = batched.addGeometry( geometry );

	place( ( i, m ) => instanced.setMatrixAt( i, m ), 20_000 );
	place( ( i, m ) => batched.setMatrixAt( batched.addInstance( id ), m ), 5_000 );

	const result = {};

	for ( const [ name, object ] of Object.entries( { instanced, batched } ) ) {

		const scene = new THREE.Scene().add( object );
		const nodes = { pass: pass( scene, camera ), peelnet: peelnetPass( scene, camera, { model: await modelOf( model ) } ) };
		const pipelines = Object.entries( nodes ).map( ( [ key, node ] ) => [ key, new THREE.RenderPipeline( renderer, node ) ] );
		const times = { pass: [], peelnet: [] };

		for ( let round = - 2; round < rounds; round ++ ) for ( const [ key, pipeline ] of pipelines ) {

			// What the program itself does is not counted.
			for ( let i = 0; i < 20; i ++ ) object.setMatrixAt( i, matrix.makeTranslation( next(), next(), next() ) );

			if ( object.isInstancedMesh === true ) object.instanceMatrix.needsUpdate = true;

			nextFrame( renderer );

			const start = performance.now();

			pipeline.render();

			if ( round >= 0 ) times[ key ].push( performance.now() - start );

			await renderer.backend.device?.queue.onSubmittedWorkDone();

		}

		result[ name ] = { pass: median( times.pass ), peelnet: median( times.peelnet ) };
		result[ name ].ratio = result[ name ].peelnet / result[ name ].pass;

	}

	return result;

}

/** Milliseconds of the first frame after compileAsync, of `pass()` and of this pass, each in a renderer of its own: medians. */
export async function afterCompiling( backend, { model = 'medium', rounds = 5 } ) {

	const times = { pass: [], peelnet: [] };

	for ( let round = 0; round < rounds; round ++ ) for ( const key of Object.keys( times ) ) {

		const renderer = await makeRenderer( backend );
		const scene = scenes.fifty();
		const camera = scenes.perspective( aspect );
		const node = key === 'pass' ? pass( scene, camera ) : peelnetPass( scene, camera, { model: await modelOf( model ) } );
		const pipeline = new THREE.RenderPipeline( renderer, node );

		await node.compileAsync( renderer );
		nextFrame( renderer );

		const start = performance.now();

		pipeline.render();
		await renderer.backend.device?.queue.onSubmittedWorkDone();
		times[ key ].push( performance.now() - start );
		renderer.dispose();
		renderer.domElement.remove();

	}

	return { pass: median( times.pass ), peelnet: median( times.peelnet ), ratio: median( times.peelnet ) / median( times.pass ) };

}

/**
 * Times of a frame, each method in turn for several rounds, so that a machine that slows down slows all of them. Every ratio is
 * of one round; the median of the rounds is returned.
 */
export async function timed( backend, { scene: name = 'fifty', models = [ 'medium' ], ranges = [ 'pixel', 'frame' ], rounds = 7, frames = 5, width = 640, height = 480, requiredLimits = {} } ) {

	const renderer = await makeRenderer( backend, { requiredLimits } );

	renderer.setSize( width, height );

	const scene = scenes[ name ]();
	const camera = scenes.perspective( width / height );
	const nodes = { sorted: pass( scene, camera ), weighted: oitPass( scene, camera ) };

	for ( const model of models ) for ( const range of ranges ) nodes[ `${ model }:${ range }` ] = peelnetPass( scene, camera, { model: await modelOf( model ), range } );

	const pipelines = Object.entries( nodes ).map( ( [ key, node ] ) => [ key, new THREE.RenderPipeline( renderer, node ) ] );
	const rows = Object.fromEntries( pipelines.map( ( [ key ] ) => [ key, { wall: [], processor: [] } ] ) );

	for ( let round = 0; round <= rounds; round ++ ) {

		for ( const [ key, pipeline ] of pipelines ) {

			const before = await window.processorTime();
			const wall = await frameTime( renderer, () => pipeline.render(), frames );
			const processor = ( await window.processorTime() - before ) / ( frames + 1 );

			// The first round compiles.
			if ( round > 0 ) {

				rows[ key ].wall.push( wall );
				rows[ key ].processor.push( processor );

			}

		}

	}

	const rounded = ( value ) => Math.round( 100 * value ) / 100;
	const result = {};

	for ( const [ key, row ] of Object.entries( rows ) ) {

		result[ key ] = { ms: rounded( median( row.wall ) ) };

		for ( const kind of [ 'wall', 'processor' ] ) result[ key ][ `of weighted, ${ kind }` ] = rounded( median( row[ kind ].map( ( time, i ) => time / rows.weighted[ kind ][ i ] ) ) );

	}

	renderer.dispose();

	return result;

}

/** The colour of a pixel with the fragments of an export's self-test, as cards that fill the view. */
export async function fourFragments( backend, { name, range, pixel } ) {

	const renderer = await makeRenderer( backend );
	const scene = new THREE.Scene();
	const camera = new THREE.PerspectiveCamera( 40, aspect, 0.1, 100 );

	scene.background = new THREE.Color().setRGB( ...pixel.background );

	// The farthest first, which must not matter.
	for ( const { z, alpha, rgb } of pixel.fragments.toReversed() ) {

		const card = new THREE.Mesh( new THREE.PlaneGeometry( 40, 40 ), new THREE.MeshBasicMaterial( { transparent: true, opacity: alpha } ) );

		card.material.color.setRGB( ...rgb );
		card.position.z = - z;
		scene.add( card );

	}

	const { image } = await drawn( renderer, scene, camera, { model: await modelOf( name ), range } );
	const at = 4 * ( HEIGHT / 2 * WIDTH + WIDTH / 2 );

	return [ ...image.slice( at, at + 3 ) ];

}

/** How far the first frame is from the third: a target's first drawing must not clear what others share. */
export async function firstFrame( backend, { model: name } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const model = await modelOf( name );
	const first = await drawn( renderer, scene, camera, { model }, 1 );
	const third = await drawn( renderer, scene, camera, { model }, 3 );

	return errors( first.image, third.image );

}

/**
 * A pass that learns from its last frames: how far its first frame is from one with the small pass, the errors of both and of its fifteenth frame,
 * and how far the first frame after a jump of the camera is from one with the small pass.
 */
export async function lastFrame( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const model = await modelOf( 'one' );
	const problems = [];
	const node = peelnetPass( scene, camera, { model, range: 'last', onProblem: ( message ) => problems.push( message ) } );
	const small = async () => ( await drawn( renderer, scene, camera, { model }, 1 ) ).image;
	const before = await small();
	const exact = await peeled( renderer, scene, camera );
	const first = errors( await imageOf( renderer, node, 1 ), before );
	const settled = errors( await imageOf( renderer, node, 15 ), exact.image );

	camera.position.x += 1;
	camera.lookAt( 0, 0, 0 );
	camera.updateMatrixWorld();

	const jumped = errors( await imageOf( renderer, node, 1 ), await small() );

	camera.position.x += 0.01;
	camera.updateMatrixWorld();

	// Made from the frame before: as the small pass shows it, but not the same.
	const moved = errors( await imageOf( renderer, node, 1 ), await small() );

	node.dispose();
	renderer.dispose();

	return { first, settled, before: errors( before, exact.image ), jumped, moved, problems };

}

/** How far the image is from that of the same objects in the opposite order, and from one drawn with three.js's sorting off. */
export async function order( backend, { model: name } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const model = await modelOf( name );
	const one = await drawn( renderer, scene, camera, { model } );

	scene.children.reverse();

	const other = await drawn( renderer, scene, camera, { model } );

	return errors( one.image, other.image );

}

/** A pass whose canvas changes its size, against a new pass of that size; and two cameras of one scene in one frame. */
export async function resized( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const model = await modelOf( 'medium' );
	const node = peelnetPass( scene, camera, { model } );
	const sizes = [];

	renderer.setSize( WIDTH / 2, HEIGHT / 2 );
	await imageOf( renderer, node );
	sizes.push( node._stages.passes.map( ( { target } ) => target.width ) );
	renderer.setSize( WIDTH, HEIGHT );

	const image = await imageOf( renderer, node, 1 );

	sizes.push( node._stages.passes.map( ( { target } ) => target.width ) );

	const fresh = await drawn( renderer, scene, camera, { model } );

	// The same pass with another camera, and back.
	node.camera = scenes.orthographic( aspect );

	const parallel = await imageOf( renderer, node );
	const freshParallel = await drawn( renderer, scene, node.camera, { model } );

	node.camera = camera;

	const back = await imageOf( renderer, node );

	// Two passes in one frame, and the finished image as an effect reads it.
	const other = peelnetPass( scene, scenes.orthographic( aspect ), { model } );
	const both = await imageOf( renderer, node.getTextureNode().add( other.getTextureNode() ) );

	return { both: errors( both, back.map( ( value, i ) => value + parallel[ i ] ) ), sizes, resized: errors( image, fresh.image ), parallel: errors( parallel, freshParallel.image ), cameras: errors( back, parallel ), back: errors( back, fresh.image ) };

}

/** The image after tone mapping, against the exact image through the same tone mapping. */
export async function toneMapped( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const exact = await peeled( renderer, scene, camera );
	const data = new THREE.DataTexture( Float32Array.from( exact.image ), WIDTH, HEIGHT, THREE.RGBAFormat, THREE.FloatType );

	data.needsUpdate = true;

	const mapped = async ( node ) => imageOf( renderer, renderOutput( node, THREE.ACESFilmicToneMapping, THREE.LinearSRGBColorSpace ) );
	const target = vec2( screenUV.x, backend === 'webgl2' ? screenUV.y.oneMinus() : screenUV.y );
	const model = await modelOf( 'medium' );
	const plain = errors( await imageOf( renderer, texture( data, target ) ), exact.image );

	return { plain, mapped: errors( await mapped( peelnetPass( scene, camera, { model } ) ), await mapped( texture( data, target ) ) ) };

}

/** A premultiplied material shows the same as a straight one. */
export async function premultiplied( backend ) {

	const renderer = await makeRenderer( backend );
	const camera = scenes.perspective( aspect );
	const model = await modelOf( 'medium' );
	const near = { color: 0xff4020, opacity: 0.6 };
	const far = { color: 0x2040ff, opacity: 0.7 };
	const straight = await drawn( renderer, scenes.twoCards( { near, far } ), camera, { model } );
	const multiplied = await drawn( renderer, scenes.twoCards( { near: { ...near, premultipliedAlpha: true }, far } ), camera, { model } );

	return errors( multiplied.image, straight.image );

}

/** A pass with a viewport and a scissor, of one card, which sorting draws right, too. */
export async function viewport( backend, { model: name } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.twoCards();
	const camera = scenes.perspective( aspect );

	scene.remove( scene.children[ 0 ] );

	const image = async ( node ) => {

		node.setViewport( 40, 30, WIDTH / 2, HEIGHT / 2 );
		// Its right edge cuts the card.
		node.setScissor( 60, 30, WIDTH / 6, HEIGHT / 2 );

		return imageOf( renderer, node );

	};

	const sorted = await image( pass( scene, camera ) );
	const whole = await imageOf( renderer, pass( scene, camera ) );

	return { same: errors( await image( peelnetPass( scene, camera, { model: await modelOf( name ) } ) ), sorted ), whole: errors( whole, sorted ) };

}

/** An additive material is drawn after the others, and the materials' own settings come back. */
export async function settings( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.twoCards();
	const camera = scenes.perspective( aspect );
	const materials = scene.children.map( ( { material } ) => material );

	materials[ 0 ].depthWrite = true;
	materials[ 1 ].forceSinglePass = false;

	const state = () => JSON.stringify( [ materials.map( ( m ) => [ m.depthWrite, m.forceSinglePass, m.side, m.version ] ), renderer.sortObjects, renderer.opaque, renderer.transparent, renderer.autoClear, renderer.autoClearDepth, renderer.lighting.enabled, scene.background?.getHex(), camera.layers.mask, renderer.getMRT(), renderer.getRenderTarget() ] );
	const before = state();
	const { image, node } = await drawn( renderer, scene, camera, { model: await modelOf( 'medium' ) } );
	const after = state();

	// The near card adds: it is drawn over the far one, as sorting does.
	materials[ 0 ].blending = THREE.AdditiveBlending;
	materials[ 0 ].needsUpdate = true;

	const added = await imageOf( renderer, node );
	const sorted = await imageOf( renderer, pass( scene, camera ) );

	return { before, after, changed: errors( added, image ), added: errors( added, sorted ) };

}

/** Ranges of z of scenes whose boxes are known, as `[near, far]`. */
export async function depthRanges( backend ) {

	const renderer = await makeRenderer( backend );
	const camera = scenes.perspective( aspect );

	camera.position.set( 0, 0, 7 );
	camera.rotation.set( 0, 0, 0 );

	const model = await modelOf( 'medium' );
	const glass = () => new THREE.MeshBasicMaterial( { transparent: true, opacity: 0.5, side: THREE.DoubleSide } );
	const card = ( z ) => {

		const mesh = new THREE.Mesh( new THREE.PlaneGeometry( 1, 1 ), glass() );

		mesh.position.z = z;

		return mesh;

	};

	const rangeOf = async ( objects, change = () => {} ) => {

		const scene = new THREE.Scene();

		scene.add( ...objects );

		const { node } = await drawn( renderer, scene, camera, { model } );

		if ( change( node ) !== undefined ) await imageOf( renderer, node );

		// What the uniform holds, read back as near and far.
		const [ , inverse, near, scale ] = node._span.value.toArray();

		return [ near, near * Math.exp( 2 / scale ) ].map( ( v ) => Math.round( v * 1e4 ) / 1e4 ).concat( Math.abs( inverse * near - 1 ) < 1e-6 );

	};

	const instances = new THREE.InstancedMesh( new THREE.PlaneGeometry( 0.5, 0.5 ), glass(), 2 );

	instances.setMatrixAt( 0, new THREE.Matrix4().setPosition( 0, 0, 1 ) );
	instances.setMatrixAt( 1, new THREE.Matrix4().setPosition( 0, 0, - 3 ) );

	const strip = scenes.skinned();

	strip.position.set( 0, 0, 0 );

	const opaque = card( 4 );

	opaque.material = new THREE.MeshBasicMaterial();

	const hidden = card( 3 );

	hidden.visible = false;

	const aside = card( 2 );

	aside.position.x = 40;

	return {
		cards: await rangeOf( [ card( 1 ), card( - 2 ) ] ),
		ignored: await rangeOf( [ card( 1 ), card( - 2 ), opaque, hidden, aside ] ),
		instances: await rangeOf( [ instances ] ),
		moved: await rangeOf( [ instances ], () => {

			instances.setMatrixAt( 1, new THREE.Matrix4().setPosition( 0, 0, - 5 ) );
			instances.instanceMatrix.needsUpdate = true;

			return true;

		} ),
		clipped: await rangeOf( [ card( 6.95 ), card( - 2 ) ] ),
		skinned: await rangeOf( [ strip ] ),
		given: await rangeOf( [ card( 1 ), card( - 2 ) ], ( node ) => ( node.depthRange = [ 2, 20 ] ) )
	};

}

// The device's own objects, counted as they are made.
export function counted( renderer ) {

	const counts = {};
	const { backend } = renderer;
	const wrap = ( object, names ) => {

		for ( const name of names ) {

			const method = object[ name ];

			object[ name ] = ( ...rest ) => {

				counts[ name ] = ( counts[ name ] ?? 0 ) + 1;

				return method.apply( object, rest );

			};

		}

	};

	if ( backend.isWebGPUBackend === true ) wrap( backend.device, [ 'createTexture', 'createBuffer', 'createShaderModule', 'createRenderPipeline', 'createBindGroup', 'createSampler' ] );
	else wrap( backend.gl, [ 'createTexture', 'createBuffer', 'createShader', 'createProgram', 'createFramebuffer', 'createRenderbuffer', 'createVertexArray' ] );

	return counts;

}

/** What frames make on the device after the first ones, with objects and camera moving. */
export async function steady( backend, { model: name } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.mixed();
	const camera = scenes.perspective( aspect );
	const pipeline = new THREE.RenderPipeline( renderer, peelnetPass( scene, camera, { model: await modelOf( name ) } ) );
	const frame = ( i ) => {

		scene.children[ 10 ].position.x = Math.sin( i );
		camera.position.x = 0.1 * i;
		nextFrame( renderer );
		pipeline.render();

	};

	for ( let i = 0; i < 3; i ++ ) frame( i );

	const counts = counted( renderer );

	for ( let i = 3; i < 13; i ++ ) frame( i );

	return counts;

}

/** What three.js counts as memory, and its objects, before a pass, with it, after changes of the model, and after dispose. */
export async function memory( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const base = pass( scene, camera );

	await imageOf( renderer, base );

	const now = () => ( { ...renderer.info.memory, renderObjects: renderer._objects._renderObjects.size, contexts: Object.keys( renderer._renderContexts._renderContexts ).length } );
	const before = now();
	const node = peelnetPass( scene, camera, { model: await modelOf( 'medium' ) } );

	await imageOf( renderer, node );

	const withPass = now();

	for ( const name of [ 'small', 'one', 'medium' ] ) {

		node.model = await modelOf( name );
		await imageOf( renderer, node );

	}

	const afterChanges = now();

	node.dispose();

	return { before, withPass, afterChanges, after: now() };

}

/** A model set at run time draws what a new pass with it draws. */
export async function swapped( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const { node, image: medium } = await drawn( renderer, scene, camera, { model: await modelOf( 'medium' ) } );

	node.model = await modelOf( 'large' );

	const large = await imageOf( renderer, node );
	const fresh = await drawn( renderer, scene, camera, { model: node.model } );

	node.range = 'frame';

	const frame = await imageOf( renderer, node );
	const freshFrame = await drawn( renderer, scene, camera, { model: node.model, range: 'frame' } );

	return { changed: errors( large, medium ), fresh: errors( large, fresh.image ), frame: errors( frame, freshFrame.image ), passes: node._stages.passes.length };

}

/** A picture of the canvas, as a data URL. */
export async function picture( backend, { scene: name = 'fifty', model = 'medium' } ) {

	const renderer = await makeRenderer( backend );

	renderer.setSize( 640, 480 );

	const pipeline = new THREE.RenderPipeline( renderer, peelnetPass( scenes[ name ](), scenes.perspective( 640 / 480 ), { model: await modelOf( model ) } ) );

	for ( let i = 0; i < 2; i ++ ) {

		nextFrame( renderer );
		pipeline.render();

	}

	return renderer.domElement.toDataURL();

}

export const versions = () => ( { three: THREE.REVISION, agent: navigator.userAgent } );
