// What programs do beside plain glass, by name like the cases. Where two cards are drawn, pixels are known in closed form.

import * as THREE from 'three/webgpu';
import { cameraProjectionMatrix, modelViewMatrix, mrt, output, pass, positionLocal, vec4 } from 'three/tsl';
import { isOrderIndependent, loadModel, peelnetPass } from '@peelnet/three';
import { counted } from './cases.js';
import { aspect, drawn, modelOf } from './helpers.js';
import { HEIGHT, WIDTH, errors, imageOf, makeRenderer, shown } from './measure.js';
import * as scenes from './scenes.js';

const over = ( below, color, alpha ) => below.map( ( c, k ) => alpha * color[ k ] + ( 1 - alpha ) * c );

// How far a pixel's shown colour is from an expected one, of 255.
const off = ( image, expected, [ x, y ] = [ WIDTH / 2, HEIGHT / 2 ] ) => Math.max( ...expected.map( ( c, k ) => Math.abs( shown( image[ 4 * ( y * WIDTH + x ) + k ] ) - shown( c ) ) ) );

async function stand( backend, options = {} ) {

	const renderer = await makeRenderer( backend, options );
	const scene = scenes.twoCards();
	const [ near, far ] = scene.children;
	const background = scene.background.toArray();
	const look = ( { material } ) => [ material.color.toArray(), material.opacity ];

	return {
		renderer, scene, near, far, background, look,
		camera: scenes.perspective( aspect ), model: await modelOf( 'medium' ),
		exact: over( over( background, ...look( far ) ), ...look( near ) ),
		swapped: over( over( background, ...look( near ) ), ...look( far ) )
	};

}

const card = ( z, material ) => {

	const mesh = new THREE.Mesh( new THREE.PlaneGeometry( 1, 1 ), material );

	mesh.position.set( 0, 0.2, z );

	return mesh;

};

/** A label that ignores depth, far behind the glass, and sparks that add before it. */
export async function overAll( backend ) {

	const { renderer, scene, camera, model, exact } = await stand( backend );
	const color = [ 0.2, 0.9, 0.4 ];
	const label = card( - 2, new THREE.MeshBasicMaterial( { color: new THREE.Color( ...color ), transparent: true, opacity: 0.5, depthTest: false } ) );

	scene.add( label );

	const labelled = await drawn( renderer, scene, camera, { model } );

	label.material = new THREE.MeshBasicMaterial( { color: new THREE.Color( ...color ), transparent: true, opacity: 0.5, blending: THREE.AdditiveBlending } );
	label.position.z = 1.5;

	const added = await imageOf( renderer, labelled.node );

	scene.remove( label );

	return {
		problems: labelled.problems,
		label: off( labelled.image, over( exact, color, 0.5 ) ),
		added: off( added, exact.map( ( c, k ) => c + 0.5 * color[ k ] ) ),
		without: off( await imageOf( renderer, labelled.node ), exact )
	};

}

/** Objects that are left out, by their data, their material's, the option, or because their fragments are their own. */
export async function leftOut( backend ) {

	const { renderer, scene, near, far, camera, model, background, look, swapped } = await stand( backend );
	const result = {};

	// What is left out is drawn after the rest: the far card over the near one.

	far.userData.peelnet = false;
	result.object = off( ( await drawn( renderer, scene, camera, { model } ) ).image, swapped );
	delete far.userData.peelnet;
	far.material.userData.peelnet = false;
	result.material = off( ( await drawn( renderer, scene, camera, { model } ) ).image, swapped );
	delete far.material.userData.peelnet;
	result.option = off( ( await drawn( renderer, scene, camera, { model, filter: ( object ) => object !== far } ) ).image, swapped );

	near.material = new THREE.NodeMaterial();
	Object.assign( near.material, { transparent: true, fragmentNode: vec4( 1, 0, 0, 0.5 ) } );
	result.fragmentNode = off( ( await drawn( renderer, scene, camera, { model } ) ).image, over( over( background, [ 1, 0, 0 ], 0.5 ), ...look( far ) ) );
	result.depthNode = isOrderIndependent( Object.assign( new THREE.NodeMaterial(), { transparent: true, depthNode: vec4( 0 ).x } ) );

	return result;

}

/** Depths are those of where a material's own vertex node puts its vertices: here the far card before the near one. */
export async function vertexNodes( backend ) {

	const { renderer, scene, far, camera, model, look, swapped } = await stand( backend );
	const [ color, opacity ] = look( far );

	far.material = new THREE.MeshBasicNodeMaterial( { transparent: true, opacity, side: THREE.DoubleSide } );
	far.material.color.setRGB( ...color );
	far.material.vertexNode = cameraProjectionMatrix.mul( modelViewMatrix ).mul( vec4( positionLocal.x, positionLocal.y, 2, 1 ) );

	const images = {};

	for ( const [ name, view ] of [ [ 'perspective', camera ], [ 'orthographic', scenes.orthographic( aspect ) ] ] ) {

		images[ name ] = off( ( await drawn( renderer, scene, view, { model, depthRange: [ 2, 12 ] } ) ).image, swapped );

	}

	return images;

}

/** Objects in a bundle, which is drawn by another pass, too. */
export async function bundled( backend ) {

	const { renderer, scene, near, far, camera, model, exact } = await stand( backend );
	const bundle = new THREE.BundleGroup();

	bundle.add( near, far );
	scene.add( bundle );

	const { node, image } = await drawn( renderer, scene, camera, { model }, 1 );
	const later = await imageOf( renderer, node, 3 );

	return { first: off( image, exact ), later: off( later, exact ), kept: renderer.backend.beginBundle === Object.getPrototypeOf( renderer.backend ).beginBundle };

}

/** A pass that is drawn after its dispose, and what the pass shows of the frame before. */
export async function again( backend ) {

	const { renderer, scene, camera, model, exact } = await stand( backend );
	const { node, problems } = await drawn( renderer, scene, camera, { model } );

	node.dispose();

	const reused = await imageOf( renderer, node );
	const previous = await imageOf( renderer, node.getPreviousTextureNode(), 3 );

	return { problems, reused: off( reused, exact ), previous: off( previous, exact ) };

}

/** Glass where an opaque object wrote the stencil. */
export async function stencilled( backend ) {

	const { renderer, scene, near, far, camera, model, background, exact } = await stand( backend, { stencil: true } );
	const mask = card( - 3, new THREE.MeshBasicMaterial( { color: scene.background, stencilWrite: true, stencilRef: 1, stencilZPass: THREE.ReplaceStencilOp } ) );

	// The left half of what is in view.
	mask.geometry = new THREE.PlaneGeometry( 20, 20 );
	mask.position.x = - 10;
	scene.add( mask );

	for ( const { material } of [ near, far ] ) Object.assign( material, { stencilWrite: true, stencilRef: 1, stencilFunc: THREE.EqualStencilFunc } );

	const { image, problems } = await drawn( renderer, scene, camera, { model, stencilBuffer: true } );

	return { problems, inside: off( image, exact, [ WIDTH / 2 - 8, HEIGHT / 2 ] ), outside: off( image, background, [ WIDTH / 2 + 8, HEIGHT / 2 ] ) };

}

/** Further outputs keep what opaque objects wrote. */
export async function outputs( backend ) {

	const { renderer, scene, camera, model, exact } = await stand( backend );
	const wall = card( - 3, new THREE.MeshBasicMaterial( { color: scene.background } ) );

	wall.geometry = new THREE.PlaneGeometry( 20, 20 );
	scene.add( wall );

	const problems = [];
	const node = peelnetPass( scene, camera, { model, onProblem: ( message ) => problems.push( message ) } );

	node.setMRT( mrt( { output, mark: vec4( 0.25, 0.5, 0.75, 1 ) } ) );

	const mark = node.getTextureNode( 'mark' );

	return { problems, output: off( await imageOf( renderer, node ), exact ), mark: off( await imageOf( renderer, mark ), [ 0.25, 0.5, 0.75 ] ) };

}

/** A material for all objects, of the scene and of the pass. */
export async function overridden( backend ) {

	const { renderer, scene, near, far, camera, model } = await stand( backend );
	// Any order is right.
	const material = new THREE.MeshBasicMaterial( { color: 0x20ff40, transparent: true, opacity: 0.5, side: THREE.DoubleSide, depthWrite: false } );

	scene.overrideMaterial = material;

	const sorted = await imageOf( renderer, pass( scene, camera ) );

	const ofScene = await drawn( renderer, scene, camera, { model } );

	scene.overrideMaterial = null;
	ofScene.node.overrideMaterial = material;

	const ofPass = await imageOf( renderer, ofScene.node );

	return { scene: errors( ofScene.image, sorted ).largest, pass: errors( ofPass, sorted ).largest, kept: near.material !== material && far.material !== material && scene.overrideMaterial === null };

}

/** How many of six disposed passes are left after garbage collection, of this package and of three.js. Needs the browser's gc(). */
export async function collected( backend ) {

	const renderer = await makeRenderer( backend );
	const model = await modelOf( 'small' );
	const make = async ( pass ) => {

		const scene = scenes.twoCards();
		const node = pass( scene, scenes.perspective( aspect ), { model } );

		await imageOf( renderer, node );
		node.dispose();

		for ( const { geometry, material } of scene.children ) {

			geometry.dispose();
			material.dispose();

		}

		return new WeakRef( node );

	};

	const left = {};

	for ( const [ name, of ] of [ [ 'three', ( scene, camera ) => pass( scene, camera ) ], [ 'peelnet', peelnetPass ] ] ) {

		const refs = [];

		for ( let i = 0; i < 6; i ++ ) refs.push( await make( of ) );

		for ( let i = 0; i < 5; i ++ ) {

			await new Promise( ( resolve ) => setTimeout( resolve, 50 ) );
			window.gc();

		}

		left[ name ] = refs.filter( ( ref ) => ref.deref() !== undefined ).length;

	}

	return left;

}

/** What the first frame after compileAsync makes of shaders and pipelines. */
export async function compiled( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const node = peelnetPass( scene, scenes.perspective( aspect ), { model: await modelOf( 'medium' ) } );

	await node.compileAsync( renderer );

	const counts = counted( renderer );

	await imageOf( renderer, node, 1 );

	return counts;

}

/** Glass behind an object that transmits light, and before it, as three.js's pass shows cards that do not meet. */
export async function transmissive( backend ) {

	const { renderer, scene, near, camera, model } = await stand( backend );
	const lens = card( 1.5, new THREE.MeshPhysicalMaterial( { transmission: 1, roughness: 0, color: 0xffe0c0 } ) );

	near.position.z = 2.5;
	scenes.lights( scene ).add( lens );

	const { image, problems } = await drawn( renderer, scene, camera, { model } );

	return { problems, ...errors( image, await imageOf( renderer, pass( scene, camera ) ) ) };

}

/** A model that is loaded by its address, and what is said of one that is not there. */
export async function loaded( backend ) {

	const { renderer, scene, camera, exact } = await stand( backend );
	const { image } = await drawn( renderer, scene, camera, { model: await loadModel( '/test/page/model' ) } );

	return { error: off( image, exact ), missing: await loadModel( '/test/page/none' ).catch( ( { message } ) => message ) };

}
