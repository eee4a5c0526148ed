// The range of depth of the transparent objects in view. The tighter it is, the better the levels of depth that a model keeps.

import { Box3, Matrix4, Vector3 } from 'three/webgpu';
import { instancesOfBatch } from './private.js';

const _empty = /*@__PURE__*/ new Box3();
const _matrix = /*@__PURE__*/ new Matrix4();
const _instance = /*@__PURE__*/ new Matrix4();
const _center = /*@__PURE__*/ new Vector3();
const _half = /*@__PURE__*/ new Vector3();

const IDENTITY = /*@__PURE__*/ new Matrix4().elements;

// Boxes by geometry, of the version of the positions that they were made from, and by bone.
const geometryBoxes = /*@__PURE__*/ new WeakMap();
const boneBoxes = /*@__PURE__*/ new WeakMap();

/** Where a distance along the view axis lies in what `write` wrote, -1 at near to 1 at far. */
export function warped( distance, { x, y, z, w } ) {

	const fromNear = y === 0 ? distance - x - z : Math.log( Math.max( distance * y, 1 ) );

	return Math.min( Math.max( fromNear * w - 1, - 1 ), 1 );

}

// Makes a box the one whose instances are added; false where it holds nothing.
function taken( box ) {

	box.getCenter( _center );
	box.getSize( _half ).multiplyScalar( 0.5 );

	return box.isEmpty() === false;

}

/** The range of z, the distance along the view axis, of everything added since `reset`. */
export class DepthRange {

	constructor() {

		this.reset();

	}

	reset() {

		this.near = Infinity;
		this.far = - Infinity;

	}

	/** Widens the range by an object's box. `viewFromWorld` is the camera's inverse matrix. */
	add( object, viewFromWorld ) {

		if ( object.isSprite === true ) return this._addSprite( object, viewFromWorld );

		if ( object.isSkinnedMesh === true && object.skeleton !== undefined ) return this._addSkinned( object, viewFromWorld );

		_matrix.multiplyMatrices( viewFromWorld, object.matrixWorld );

		if ( object.isInstancedMesh === true ) return this._addInstances( object, _matrix.elements );

		if ( object.isBatchedMesh === true ) return this._addBatch( object, _matrix.elements );

		this._addBox( geometryBox( object.geometry ), _matrix );

	}

	/**
	 * Writes what shaders need of the range, clipped to that of the cameras, which are of one kind: what to subtract from z, then the fields of the texts'
	 * PeelnetRange, as their function peelnet_range computes them. An orthographic camera's z starts at 0 in it, which makes the
	 * scale of depth linear.
	 */
	write( cameras, target ) {

		const nearest = Math.min( ...cameras.map( ( camera ) => camera.near ) );
		const farthest = Math.max( ...cameras.map( ( camera ) => camera.far ) );
		let near = Math.max( this.near, nearest );
		let far = Math.min( this.far, farthest );

		// Boxes that do not bound what a shader moves may lie outside of the camera's range.
		if ( ! ( near <= far ) ) {

			near = nearest;
			far = farthest;

		}

		if ( cameras[ 0 ].isPerspectiveCamera === true && near > 0 ) {

			const extent = Math.log( far / near );

			// Closer than that, depths hardly differ.
			return target.set( 0, 1 / near, near, extent <= 1e-6 ? 0 : 2 / extent );

		}

		return target.set( near, 0, 0, far > near ? 2 / ( far - near ) : 0 );

	}

	_addBox( box, viewFromLocal ) {

		if ( taken( box ) ) this._addInstance( IDENTITY, 0, viewFromLocal.elements );

	}

	// Tens of thousands may move in every frame: z alone is computed of each, and no box is made.
	_addInstances( { instanceMatrix: { array }, count, geometry }, m ) {

		if ( taken( geometryBox( geometry ) ) === false ) return;

		for ( let i = 0; i < count; i ++ ) this._addInstance( array, 16 * i, m );

	}

	_addBatch( mesh, m ) {

		const boxes = new Map();

		for ( const [ i, geometry ] of instancesOfBatch( mesh ) ) {

			if ( boxes.has( geometry ) === false ) boxes.set( geometry, mesh.getBoundingBoxAt( geometry, new Box3() ) );

			if ( taken( boxes.get( geometry ) ) ) this._addInstance( mesh.getMatrixAt( i, _instance ).elements, 0, m );

		}

	}

	// The box that was taken, moved by the matrix at a place of an array and then by `m`.
	_addInstance( array, at, m ) {

		const x = m[ 2 ] * array[ at ] + m[ 6 ] * array[ at + 1 ] + m[ 10 ] * array[ at + 2 ];
		const y = m[ 2 ] * array[ at + 4 ] + m[ 6 ] * array[ at + 5 ] + m[ 10 ] * array[ at + 6 ];
		const z = m[ 2 ] * array[ at + 8 ] + m[ 6 ] * array[ at + 9 ] + m[ 10 ] * array[ at + 10 ];
		const w = m[ 2 ] * array[ at + 12 ] + m[ 6 ] * array[ at + 13 ] + m[ 10 ] * array[ at + 14 ] + m[ 14 ];
		const middle = - ( x * _center.x + y * _center.y + z * _center.z + w );
		const extent = Math.abs( x ) * _half.x + Math.abs( y ) * _half.y + Math.abs( z ) * _half.z;

		this._addInterval( middle - extent, middle + extent );

	}

	_addInterval( near, far ) {

		if ( Number.isFinite( near ) && Number.isFinite( far ) ) {

			this.near = Math.min( this.near, near );
			this.far = Math.max( this.far, far );

		}

	}

	// A sprite faces the camera: all of it lies at the depth of its origin.
	_addSprite( sprite, viewFromWorld ) {

		_center.setFromMatrixPosition( sprite.matrixWorld ).applyMatrix4( viewFromWorld );

		this._addInterval( - _center.z, - _center.z );

	}

	// A skinned vertex is a mean of where its bones carry it, so the boxes of the bones' own vertices bound it in every pose.
	_addSkinned( mesh, viewFromWorld ) {

		const { bones, boneInverses } = mesh.skeleton;
		const boxes = boxesByBone( mesh );

		for ( let i = 0; i < bones.length; i ++ ) {

			if ( boxes[ i ].isEmpty() ) continue;

			// From the mesh as it was bound to the bone, to where the bone is now.
			_matrix.multiplyMatrices( bones[ i ].matrixWorld, boneInverses[ i ] ).multiply( mesh.bindMatrix );

			// Attached meshes carry their own matrix in `bindMatrixInverse`; the product is the world's.
			_matrix.premultiply( mesh.bindMatrixInverse ).premultiply( mesh.matrixWorld ).premultiply( viewFromWorld );

			this._addBox( boxes[ i ], _matrix );

		}

	}

}

function geometryBox( geometry ) {

	const position = geometry.attributes.position;

	if ( position === undefined ) return _empty;

	const version = position.isInterleavedBufferAttribute === true ? position.data.version : position.version;
	let entry = geometryBoxes.get( geometry );

	if ( entry === undefined || entry.version !== version || entry.position !== position ) {

		// A box that the user set bounds what shaders do to the vertices, too: it is kept while the positions stay.
		if ( geometry.boundingBox === null || entry !== undefined ) geometry.computeBoundingBox();

		entry = { version, position };
		geometryBoxes.set( geometry, entry );

	}

	return geometry.boundingBox;

}

function boxesByBone( mesh ) {

	const { geometry } = mesh;
	const { position, skinIndex, skinWeight } = geometry.attributes;
	let boxes = boneBoxes.get( geometry );

	if ( boxes === undefined ) {

		boxes = mesh.skeleton.bones.map( () => new Box3() );

		for ( let i = 0; i < position.count; i ++ ) {

			_center.fromBufferAttribute( position, i );

			for ( let k = 0; k < 4; k ++ ) {

				if ( skinWeight.getComponent( i, k ) > 0 ) boxes[ skinIndex.getComponent( i, k ) ]?.expandByPoint( _center );

			}

		}

		boneBoxes.set( geometry, boxes );

	}

	return boxes;

}
