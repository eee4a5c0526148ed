import * as THREE from 'three/webgpu';
import { pass } from 'three/tsl';
import { oitPass } from 'three/addons/tsl/display/OITPassNode.js';
import { peelnetPass } from '@peelnet/three';
import { frameTime, imageOf, makeRenderer, nextFrame } from './measure.js';
import * as scenes from './scenes.js';
export async function profile( backend, { model = 'medium', rounds = 6, frames = 3 } ) {
	const renderer = await makeRenderer( backend );
	renderer.setSize( 640, 480 );
	const scene = scenes.fifty(); const camera = scenes.perspective( 640 / 480 );
	const m = ( await import( `@peelnet/three/models/${ model }.js` ) ).default;
	const mk = ( f ) => { const n = peelnetPass( scene, camera, { model: m } ); const p = new THREE.RenderPipeline( renderer, n ); p.render(); f( n ); return p; };
	const noquad = ( n ) => ( n._stages.quad.render = () => {} );
	const base = pass( scene, camera ); base.transparent = false;
	const ps = {
		opaque: new THREE.RenderPipeline( renderer, base ),
		sorted: new THREE.RenderPipeline( renderer, pass( scene, camera ) ),
		weighted: new THREE.RenderPipeline( renderer, oitPass( scene, camera ) ),
		none: mk( ( n ) => { noquad( n ); n._stages.passes = []; } ),
		range: mk( ( n ) => { noquad( n ); n._stages.passes = n._stages.passes.slice( 0, 1 ); } ),
		statistics: mk( ( n ) => { noquad( n ); n._stages.passes = n._stages.passes.slice( 1, 2 ); } ),
		weights: mk( ( n ) => { noquad( n ); n._stages.passes = n._stages.passes.slice( 2 ); } ),
		resolve: mk( ( n ) => { n._stages.passes = []; } ),
		all: mk( () => {} )
	};
	const t = Object.fromEntries( Object.keys( ps ).map( ( k ) => [ k, [] ] ) );
	for ( let r = 0; r <= rounds; r ++ ) for ( const k in ps ) { const c0 = await window.cpu(); const x = await frameTime( renderer, () => ps[ k ].render(), frames ); const c1 = await window.cpu(); if ( r ) t[ k ].push( ( c1 - c0 ) / ( frames + 1 ) ); }
	return Object.fromEntries( Object.entries( t ).map( ( [ k, v ] ) => [ k, Math.min( ...v ).toFixed( 1 ) ] ) );
}
export async function dump( backend ) {
	const renderer = await makeRenderer( backend );
	const texts = [];
	const d = renderer.backend.device; const c = d.createShaderModule.bind( d );
	d.createShaderModule = ( x ) => { texts.push( x.code ); return c( x ); };
	const scene = scenes.fifty(); const camera = scenes.perspective( 640 / 480 );
	const m = ( await import( '@peelnet/three/models/medium.js' ) ).default;
	await imageOf( renderer, peelnetPass( scene, camera, { model: m } ), 1 );
	return texts.filter( ( t ) => t.includes( 'peelnet_pass' ) );
}
export async function pieces( backend, { rounds = 6, frames = 3 } ) {
	const renderer = await makeRenderer( backend );
	renderer.setSize( 640, 480 );
	const scene = scenes.fifty(); const camera = scenes.perspective( 640 / 480 );
	const m = ( await import( `@peelnet/three/models/medium.js` ) ).default;
	const mk = ( w, f = ( x ) => x, stage = 2, st ) => {
		const d = structuredClone( m.description );
		if ( w ) d.passes[ 2 ].compute = w;
		if ( st ) st( d.passes[ 1 ] );
		const n = peelnetPass( scene, camera, { model: { ...m, wgsl: f( m.wgsl ), description: d } } ); const p = new THREE.RenderPipeline( renderer, n ); p.render(); n._stages.quad.render = () => {}; n._stages.passes = n._stages.passes.slice( stage, stage + 1 ); return p; };
	const base = pass( scene, camera ); base.transparent = false;
	const ps = {
		opaque: new THREE.RenderPipeline( renderer, base ),
		w1: mk( 'let w = 1.0;' ),
		loads: mk( 'let w = absorbances.x + nearest.x + farthest.x + range.x;' ),
		zeta: mk( 'let w = absorbances.x + nearest.x + farthest.x + range.x + zeta;' ),
		place: mk( 'let w = absorbances.x + nearest.x + farthest.x + peelnet_place(alpha, zeta, range).near;' ),
		nonet: mk( null, ( t ) => t.replace( /fn peelnet_network\(([^]*?)\{[^]*?\n\}/, 'fn peelnet_network($1{ return between.place + between.mean; }' ) ),
		full: mk( null ),
		range: mk( null, ( x ) => x, 0 ),
		stats: mk( null, ( x ) => x, 1 ),
		statsZero: mk( null, ( x ) => x, 1, ( p ) => { p.compute = ''; p.targets.forEach( ( t ) => ( t.write = 'vec4f(alpha)' ) ); } ),
		statsPlace: mk( null, ( x ) => x, 1, ( p ) => { p.compute = 'let s = peelnet_place(alpha, zeta, range);'; p.targets.forEach( ( t ) => ( t.write = 'vec4f(s.near, s.far, s.inside, s.slab)' ) ); } ),
	};
	const t = Object.fromEntries( Object.keys( ps ).map( ( k ) => [ k, [] ] ) );
	for ( let r = 0; r <= rounds; r ++ ) for ( const k in ps ) { const c0 = await window.cpu(); const x = await frameTime( renderer, () => ps[ k ].render(), frames ); const c1 = await window.cpu(); if ( r ) t[ k ].push( ( c1 - c0 ) / ( frames + 1 ) ); }
	return Object.fromEntries( Object.entries( t ).map( ( [ k, v ] ) => [ k, Math.min( ...v ).toFixed( 1 ) ] ) );
}
export async function tm( backend ) {
	const { renderOutput } = await import( 'three/tsl' );
	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty(); const camera = scenes.perspective( 320 / 240 );
	const m = ( await import( '@peelnet/three/models/medium.js' ) ).default;
	const px = ( a ) => [ ...a.slice( 4 * ( 120 * 320 + 160 ), 4 * ( 120 * 320 + 160 ) + 4 ) ];
	const o = {};
	o.peel = px( await imageOf( renderer, peelnetPass( scene, camera, { model: m } ) ) );
	o.peelT = px( await imageOf( renderer, renderOutput( peelnetPass( scene, camera, { model: m } ), THREE.ACESFilmicToneMapping, THREE.LinearSRGBColorSpace ) ) );
	o.passT = px( await imageOf( renderer, renderOutput( pass( scene, camera ), THREE.ACESFilmicToneMapping, THREE.LinearSRGBColorSpace ) ) );
	o.pass = px( await imageOf( renderer, renderOutput( pass( scene, camera ), THREE.NoToneMapping, THREE.LinearSRGBColorSpace ) ) );
	o.oitT = px( await imageOf( renderer, renderOutput( oitPass( scene, camera ), THREE.ACESFilmicToneMapping, THREE.LinearSRGBColorSpace ) ) );
	return o;
}
export async function copies( backend ) {
	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty(); const camera = scenes.perspective( 320 / 240 );
	const p = new THREE.RenderPipeline( renderer, pass( scene, camera ) );
	const c = document.createElement( 'canvas' ); c.width = 320; c.height = 240; const x = c.getContext( '2d', { willReadFrequently: true } );
	const mean = () => { const d = x.getImageData( 0, 0, 320, 240 ).data; let s = 0; for ( const v of d ) s += v; return s / d.length; };
	const o = {};
	nextFrame( renderer ); p.render(); x.drawImage( renderer.domElement, 0, 0 ); o.attached = mean();
	nextFrame( renderer ); p.render(); const b = await createImageBitmap( renderer.domElement ); x.clearRect( 0, 0, 320, 240 ); x.drawImage( b, 0, 0 ); o.bitmap = mean();
	nextFrame( renderer ); p.render(); const u = renderer.domElement.toDataURL(); const im = new Image(); im.src = u; await im.decode(); x.clearRect( 0, 0, 320, 240 ); x.drawImage( im, 0, 0 ); o.url = mean();
	const c2 = document.createElement( 'canvas' ); c2.width = 320; c2.height = 240; const x2 = c2.getContext( '2d' ); nextFrame( renderer ); p.render(); x2.drawImage( renderer.domElement, 0, 0 ); x.clearRect( 0, 0, 320, 240 ); x.drawImage( c2, 0, 0 ); o.plain2d = mean();
	renderer.domElement.remove(); nextFrame( renderer ); p.render(); x.drawImage( renderer.domElement, 0, 0 ); o.detached = mean();
	return o;
}
