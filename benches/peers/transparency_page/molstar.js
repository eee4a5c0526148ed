// Mol*: its weighted blending and its blending without sorting.

import { Mesh } from 'molstar/lib/mol-geo/geometry/mesh/mesh.js';
import { createRenderObject } from 'molstar/lib/mol-gl/render-object.js';
import { Canvas3D, Canvas3DContext } from 'molstar/lib/mol-canvas3d/canvas3d.js';
import { Vec3 } from 'molstar/lib/mol-math/linear-algebra.js';
import { Representation } from 'molstar/lib/mol-repr/representation.js';
import { AssetManager } from 'molstar/lib/mol-util/assets.js';
import { Color } from 'molstar/lib/mol-util/color/index.js';
import { ValueCell } from 'molstar/lib/mol-util/value-cell.js';
import { meshes } from './glb.js';
import { peer } from './draw.js';

const off = { name: 'off', params: {} };

const method = ( file, transparency ) => async ( { camera: given, background, width, height } ) => {

	const canvas = document.createElement( 'canvas' );

	Object.assign( canvas, { width, height } );
	canvas.style.cssText = `width:${ width }px;height:${ height }px`;
	document.body.append( canvas );

	const context = Canvas3DContext.fromCanvas( canvas, new AssetManager(), { antialias: false }, { transparency } );
	const canvas3d = Canvas3D.create( context );

	canvas3d.setProps( {
		camera: { mode: 'perspective', helper: { axes: off }, manualReset: true }, cameraFog: off, cameraClipping: { radius: 0, far: false, minNear: given.near },
		multiSample: { mode: 'off' }, postprocessing: { enabled: false }, hiZ: { enabled: false }, renderer: { backgroundColor: Color.fromNormalizedArray( background, 0 ) }
	} );

	for ( const { points, triangles, color, alpha } of await meshes( `/${ file }.glb` ) ) {

		const mesh = Mesh.create( points, triangles, new Float32Array( points.length ), new Float32Array( points.length / 3 ), points.length / 3, triangles.length / 3 );
		const props = { alpha, ignoreLight: true, doubleSided: true, transparentBackfaces: 'on', interior: { color: Color( 0 ), colorStrength: 0, substance: { metalness: 0, roughness: 0, bumpiness: 0 }, substanceStrength: 0 } };
		const values = Mesh.Utils.createValuesSimple( mesh, props, Color( 0 ), 1 );

		// Its colours have 8 bits, the uniform has more.
		ValueCell.update( values.uColor, Vec3.fromArray( Vec3(), color, 0 ) );
		canvas3d.add( Representation.fromRenderObject( file, createRenderObject( 'mesh', values, Mesh.Utils.createRenderableState( props ), - 1 ) ) );

	}

	canvas3d.commit( true );
	canvas3d.camera.setState( { position: Vec3.create( ...given.position ), target: Vec3.create( ...given.target ), up: Vec3.create( ...given.up ), fov: given.fov_y * Math.PI / 180, radius: 4, radiusMax: 4, fog: 0, clipFar: false }, 0 );

	return {
		canvas,
		draw() {

			canvas3d.requestDraw();
			canvas3d.tick( performance.now(), { isSynchronous: true } );

		}
	};

};

peer( { opaque: method( 'opaque', 'wboit' ), 'weighted blending': method( 'scene', 'wboit' ), blending: method( 'scene', 'blended' ) } );
