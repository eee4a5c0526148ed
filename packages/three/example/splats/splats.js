// Gaussian splats (Kerbl et al. 2023) as one mesh of instanced quads. `peelnetPass` draws it with the glass among the splats; nothing is sorted.
//
// The vertex shader projects each splat's covariance Σ to the screen: J Σ Jᵀ, J being the derivative of pixels by object space at the centre. The
// quad ends where opacity · exp( -g² / 2 ) falls below 1/255. Across the quad, depth is the mean of the Gaussian's depth given the pixel, which is
// a plane through the centre: so splats and panes that cross one another cross smoothly.
//
// Colours of splats are display-space (sRGB) values. three.js blends in linear light, so they are decoded here. Training blends display-space
// values: captures look lighter here where splats of low opacity overlap.

import { Box3, BufferAttribute, DoubleSide, InstancedBufferAttribute, InstancedBufferGeometry, Matrix3, Matrix4, Mesh, MeshBasicNodeMaterial, Quaternion, Sphere, Vector3 } from 'three/webgpu';
import { abs, attribute, cameraNear, cameraProjectionMatrix, dot, exp, float, mat3, max, min, modelViewMatrix, sRGBTransferEOTF, transpose, varying, vec2, vec3, vec4, viewportSize } from 'three/tsl';

/** Bytes of a splat in a `.splat` file: centre and scale as f32 × 3, then RGBA and rotation as u8 × 4. */
export const SPLAT_BYTES = 32;

// Fragments of less opacity are not drawn, and none has more: as in the reference renderer of Kerbl et al.
const LEAST_OPACITY = 1 / 255;
const MOST_OPACITY = 0.99;
// Variance, px², that keeps a splat from falling between pixels.
const BLUR = 0.3;
// The derivative is that at the border of this times the frame for centres farther out, where it grows without bound.
const BORDER = 1.3;
// 1 / depth changes by so much of itself across a quad at most: all of a splat stays before the camera.
const MOST_SLOPE = 0.5;
// Scenes are smaller than that in any unit in use; bytes that are no numbers rarely are.
const FARTHEST = 1e6;

const FIX = 'Export the scene as .splat (32 bytes a splat), for example with SuperSplat or convert.py of antimatter15/splat.';

/** What is wrong with bytes that should be a `.splat` file, as one sentence and a fix, or null. */
export function splatProblem( buffer ) {

	const { byteLength } = buffer;

	if ( byteLength === 0 ) return `The file is empty. ${ FIX }`;

	const start = String.fromCharCode( ...new Uint8Array( buffer, 0, Math.min( 4, byteLength ) ) );

	if ( /^ply\s/.test( start ) ) return `The file is a PLY. ${ FIX }`;
	if ( byteLength % SPLAT_BYTES !== 0 ) return `The file has ${ byteLength } bytes, no multiple of ${ SPLAT_BYTES }: it is cut or no .splat. ${ FIX }`;

	const view = new DataView( buffer );

	for ( let at = 0; at < byteLength; at += SPLAT_BYTES ) {

		for ( let k = 0; k < 24; k += 4 ) {

			// NaN is not less, either.
			if ( ! ( Math.abs( view.getFloat32( at + k, true ) ) < FARTHEST ) ) return `Splat ${ at / SPLAT_BYTES } has no valid ${ k < 12 ? 'centre' : 'scale' }: the file is damaged or no .splat. ${ FIX }`;

		}

		// Four times 128: a quaternion of length 0.
		if ( view.getUint32( at + 28, true ) === 0x80808080 ) return `Splat ${ at / SPLAT_BYTES } has no valid rotation: the file is damaged or no .splat. ${ FIX }`;

	}

	return null;

}

/**
 * The splats of a `.splat` file (antimatter15/splat), or an error with one sentence and a fix.
 *
 * @param {ArrayBuffer} buffer
 * @returns {{ count: number, centers: Float32Array, scales: Float32Array, rotations: Float32Array, colors: Uint8Array }} x y z, standard deviations,
 * unit quaternions x y z w, and display-space RGBA
 */
export function splatsFrom( buffer ) {

	const problem = splatProblem( buffer );

	if ( problem !== null ) throw new Error( problem );

	const count = buffer.byteLength / SPLAT_BYTES;
	const view = new DataView( buffer );
	const centers = new Float32Array( 3 * count );
	const scales = new Float32Array( 3 * count );
	const rotations = new Float32Array( 4 * count );
	const colors = new Uint8Array( 4 * count );
	const rotation = new Quaternion();

	for ( let i = 0, at = 0; i < count; i ++, at += SPLAT_BYTES ) {

		for ( let k = 0; k < 3; k ++ ) {

			centers[ 3 * i + k ] = view.getFloat32( at + 4 * k, true );
			scales[ 3 * i + k ] = view.getFloat32( at + 12 + 4 * k, true );

		}

		for ( let k = 0; k < 4; k ++ ) colors[ 4 * i + k ] = view.getUint8( at + 24 + k );

		const [ w, x, y, z ] = [ 28, 29, 30, 31 ].map( ( k ) => ( view.getUint8( at + k ) - 128 ) / 128 );

		rotation.set( x, y, z, w ).normalize().toArray( rotations, 4 * i );

	}

	return { count, centers, scales, rotations, colors };

}

// Σ = R S Sᵀ Rᵀ of each splat, as xx yy zz and as xy xz yz, and a box around all that is drawn of them.
function covariancesOf( { count, centers, scales, rotations } ) {

	const variances = new Float32Array( 3 * count );
	const covariances = new Float32Array( 3 * count );
	const box = new Box3();
	const axes = new Matrix3();
	const rotation = new Matrix4();
	const quaternion = new Quaternion();
	const center = new Vector3();
	const reach = new Vector3();
	const most = Math.sqrt( - 2 * Math.log( LEAST_OPACITY ) );

	for ( let i = 0; i < count; i ++ ) {

		const { elements: m } = axes.setFromMatrix4( rotation.makeRotationFromQuaternion( quaternion.fromArray( rotations, 4 * i ) ) );

		for ( let k = 0; k < 9; k ++ ) m[ k ] *= scales[ 3 * i + Math.floor( k / 3 ) ];

		const sum = ( a, b ) => m[ a ] * m[ b ] + m[ a + 3 ] * m[ b + 3 ] + m[ a + 6 ] * m[ b + 6 ];

		variances.set( [ sum( 0, 0 ), sum( 1, 1 ), sum( 2, 2 ) ], 3 * i );
		covariances.set( [ sum( 0, 1 ), sum( 0, 2 ), sum( 1, 2 ) ], 3 * i );
		center.fromArray( centers, 3 * i );
		reach.fromArray( variances, 3 * i );
		reach.set( Math.sqrt( reach.x ), Math.sqrt( reach.y ), Math.sqrt( reach.z ) ).multiplyScalar( most );
		box.expandByPoint( center.sub( reach ) ).expandByPoint( center.addScaledVector( reach, 2 ) );

	}

	return { variances, covariances, box };

}

function splatMaterial() {

	const material = new MeshBasicNodeMaterial( { transparent: true, depthWrite: false, side: DoubleSide, forceSinglePass: true, fog: false, alphaTest: LEAST_OPACITY } );
	const center = attribute( 'splatCenter', 'vec3' );
	const variance = attribute( 'splatVariance', 'vec3' );
	const covariance = attribute( 'splatCovariance', 'vec3' );
	const color = attribute( 'splatColor', 'vec4' );
	const corner = attribute( 'position', 'vec3' ).xy;

	const sigma = mat3( vec3( variance.x, covariance.x, covariance.y ), vec3( covariance.x, variance.y, covariance.z ), vec3( covariance.y, covariance.z, variance.z ) );
	const clipFromObject = cameraProjectionMatrix.mul( modelViewMatrix );
	const rows = transpose( clipFromObject );
	const [ rowX, rowY, rowW ] = [ 0, 1, 3 ].map( ( row ) => rows.element( row ).xyz );
	const clip = clipFromObject.mul( vec4( center, 1 ) );
	const ndc = clip.xy.div( clip.w );

	// Rows of J, and the derivative of depth (distance along the view axis; a perspective camera's is rowW).
	const derivative = ( row, at ) => row.sub( rowW.mul( at.clamp( - BORDER, BORDER ) ) ).div( clip.w );
	const jacobianX = derivative( rowX, ndc.x ).mul( viewportSize.x.mul( 0.5 ) );
	const jacobianY = derivative( rowY, ndc.y ).mul( viewportSize.y.mul( 0.5 ) );
	const gradient = transpose( modelViewMatrix ).element( 2 ).xyz.negate();

	// Σ_xy = L Lᵀ (Cholesky), Σ_xy being J Σ Jᵀ and the blur: L carries the unit circle to one standard deviation in pixels.
	const sigmaX = sigma.mul( jacobianX );
	const sigmaY = sigma.mul( jacobianY );
	const left = dot( jacobianX, sigmaX ).add( BLUR ).sqrt();
	const slant = dot( jacobianX, sigmaY ).div( left );
	// Of a sum with BLUR · 1 it is BLUR at least, which rounding must not undercut.
	const right = max( dot( jacobianY, sigmaY ).add( BLUR ).sub( slant.mul( slant ) ), BLUR ).sqrt();

	// In units of standard deviations, where opacity falls below the least.
	const reach = max( color.a.div( LEAST_OPACITY ), 1 ).log().mul( 2 ).sqrt();
	const gauss = corner.mul( reach );
	const offset = vec2( left.mul( gauss.x ), slant.mul( gauss.x ).add( right.mul( gauss.y ) ) );

	// The mean of depth given the pixel is depth + Σ_depth,xy · Σ_xy⁻¹ · offset, which is depth + slope · gauss with slope = L⁻¹ Σ_xy,depth.
	const depth = modelViewMatrix.mul( vec4( center, 1 ) ).z.negate();
	const slopeX = dot( gradient, sigmaX ).div( left );
	const slope = vec2( slopeX, dot( gradient, sigmaY ).sub( slant.mul( slopeX ) ).div( right ) );
	const difference = dot( slope, gauss );
	const largest = reach.mul( abs( slope.x ).add( abs( slope.y ) ) );

	// 1 / depth is what is linear on the screen under perspective. An orthographic camera's w is 1, and depth itself is linear.
	const relative = difference.div( depth ).mul( min( 1, depth.mul( MOST_SLOPE ).div( max( largest, 1e-20 ) ) ) );
	const isOrthographic = cameraProjectionMatrix.element( 3 ).w.equal( 1 );
	const cornerDepth = isOrthographic.select( depth.add( difference ), depth.div( float( 1 ).sub( relative ) ) );
	const cornerZw = cameraProjectionMatrix.mul( vec4( 0, 0, cornerDepth.negate(), 1 ) ).zw;
	const cornerXy = ndc.add( offset.mul( 2 ).div( viewportSize ) ).mul( cornerZw.y );
	const isSeen = depth.greaterThan( cameraNear ).and( color.a.greaterThan( LEAST_OPACITY ) );

	// What is not drawn lies behind the far plane.
	material.vertexNode = isSeen.select( vec4( cornerXy, cornerZw ), vec4( 0, 0, 2, 1 ) );

	// Linear on the screen, not on the plane: multiplied by w here, divided by it in each fragment.
	const scaled = varying( vec3( gauss, 1 ).mul( cornerZw.y ) );
	const g = scaled.xy.div( scaled.z );

	material.colorNode = varying( sRGBTransferEOTF( color.rgb ) );
	material.opacityNode = min( varying( color.a ).mul( exp( dot( g, g ).mul( - 0.5 ) ) ), MOST_OPACITY );

	return material;

}

/**
 * A mesh of splats as `splatsFrom` returns them. It can be moved, turned and scaled like any other.
 *
 * @returns {Mesh}
 */
export function createSplats( splats ) {

	const { variances, covariances, box } = covariancesOf( splats );
	const geometry = new InstancedBufferGeometry();

	geometry.setAttribute( 'position', new BufferAttribute( new Float32Array( [ - 1, - 1, 0, 1, - 1, 0, - 1, 1, 0, 1, 1, 0 ] ), 3 ) );
	geometry.setIndex( [ 0, 1, 2, 2, 1, 3 ] );
	geometry.setAttribute( 'splatCenter', new InstancedBufferAttribute( splats.centers, 3 ) );
	geometry.setAttribute( 'splatVariance', new InstancedBufferAttribute( variances, 3 ) );
	geometry.setAttribute( 'splatCovariance', new InstancedBufferAttribute( covariances, 3 ) );
	geometry.setAttribute( 'splatColor', new InstancedBufferAttribute( splats.colors, 4, true ) );
	geometry.instanceCount = splats.count;

	// The positions are those of one quad. `peelnetPass` takes its range of depth from this box.
	geometry.boundingBox = box;
	geometry.boundingSphere = box.getBoundingSphere( new Sphere() );

	return new Mesh( geometry, splatMaterial() );

}
