// Cesium: its weighted blending, and its blending without it, which is sorted.

import { Axis, Cartesian3, Color, CustomShader, Math as Angles, Matrix4, Model, PerspectiveFrustum, Scene } from '@cesium/engine';
import { peer } from './draw.js';

// No data of the earth is asked for.
window.CESIUM_BASE_URL = '/';

const method = ( file, orderIndependentTranslucency ) => async ( { camera: given, background, width, height } ) => {

	const canvas = document.createElement( 'canvas' );

	Object.assign( canvas, { width, height } );
	document.body.append( canvas );

	const scene = new Scene( { canvas, orderIndependentTranslucency, msaaSamples: 1, contextOptions: { webgl: { antialias: false, alpha: false } } } );

	scene.rethrowRenderErrors = true;
	scene.backgroundColor = new Color( ...background, 1 );
	scene.highDynamicRange = false;
	scene.logarithmicDepthBuffer = false;

	// Its frustum has the angle of the wider side.
	const tangent = Math.tan( Angles.toRadians( given.fov_y ) / 2 ) * Math.max( 1, width / height );

	scene.camera.frustum = new PerspectiveFrustum( { fov: 2 * Math.atan( tangent ), aspectRatio: width / height, near: given.near, far: given.far } );

	const position = new Cartesian3( ...given.position );
	const direction = Cartesian3.normalize( Cartesian3.subtract( new Cartesian3( ...given.target ), position, new Cartesian3() ), new Cartesian3() );
	const right = Cartesian3.normalize( Cartesian3.cross( direction, new Cartesian3( ...given.up ), new Cartesian3() ), new Cartesian3() );

	// Not by setView, which goes by angles over the ground.
	Object.assign( scene.camera, { position, direction, right, up: Cartesian3.cross( right, direction, new Cartesian3() ) } );

	// It encodes colours for a display before it blends them: decoded before, they are blended as they are.
	const customShader = new CustomShader( { fragmentShaderText: 'void fragmentMain(FragmentInput fragment, inout czm_modelMaterial material) { material.diffuse = czm_srgbToLinear(material.diffuse); }' } );
	const model = scene.primitives.add( await Model.fromGltfAsync( { url: `/${ file }.glb`, upAxis: Axis.Z, forwardAxis: Axis.X, customShader, modelMatrix: Matrix4.IDENTITY } ) );

	while ( model.ready === false ) {

		scene.render();
		await new Promise( ( done ) => setTimeout( done, 10 ) );

	}

	return { canvas, draw: () => scene.render() };

};

peer( { opaque: method( 'opaque', true ), 'weighted blending': method( 'scene', true ), 'sorted blending': method( 'scene', false ) } );
