// The range of depth of the transparent objects in view. The tighter it is, the better the levels of depth that a model keeps.

import { Box3, Matrix4, Vector3 } from 'three/webgpu';

const _empty = /*@__PURE__*/ new Box3();
const _instance = /*@__PURE__*/ new Box3();
const _matrix = /*@__PURE__*/ new Matrix4();
const _center = /*@__PURE__*/ new Vector3();
const _half = /*@__PURE__*/ new Vector3();

// Boxes by geometry, of the version of the positions that they were made from.
const geometryBoxes = /*@__PURE__*/ new WeakMap();
const instanceBoxes = /*@__PURE__*/ new WeakMap();
const boneBoxes = /*@__PURE__*/ new WeakMap();

/** Where a distance along the view axis lies in what `write` wrote, -1 at near to 1 at far. */
export function warped( distance, { x, y, z, w } ) {

	const fromNear = y === 0 ? distance - x - z : Math.log( Math.max( distance * y, 1 ) );

	return Math.min( Math.max( fromNear * w - 1, - 1 ), 1 );

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

		this._addBox( localBox( object ), _matrix.multiplyMatrices( viewFromWorld, object.matrixWorld ) );

	}

	/**
	 * Writes what shaders need of the range, clipped to the camera's: what to subtract from z, then the fields of the texts'
	 * PeelnetRange, as their function peelnet_range computes them. An orthographic camera's z starts at 0 in it, which makes the
	 * scale of depth linear.
	 */
	write( camera, target ) {

		let near = Math.max( this.near, camera.near );
		let far = Math.min( this.far, camera.far );

		// Boxes that do not bound what a shader moves may lie outside of the camera's range.
		if ( ! ( near <= far ) ) {

			near = camera.near;
			far = camera.far;

		}

		if ( camera.isPerspectiveCamera === true && near > 0 ) {

			const extent = Math.log( far / near );

			// Closer than that, depths hardly differ.
			return target.set( 0, 1 / near, near, extent <= 1e-6 ? 0 : 2 / extent );

		}

		return target.set( near, 0, 0, far > near ? 2 / ( far - near ) : 0 );

	}

	_addBox( box, viewFromLocal ) {

		if ( box.isEmpty() ) return;

		box.getCenter( _center );
		box.getSize( _half ).multiplyScalar( 0.5 );

		const m = viewFromLocal.elements;
		const z = - ( m[ 2 ] * _center.x + m[ 6 ] * _center.y + m[ 10 ] * _center.z + m[ 14 ] );
		const extent = Math.abs( m[ 2 ] ) * _half.x + Math.abs( m[ 6 ] ) * _half.y + Math.abs( m[ 10 ] ) * _half.z;

		this._addInterval( z - extent, z + extent );

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

function localBox( object ) {

	if ( object.isInstancedMesh === true ) return instancedBox( object );

	if ( object.isBatchedMesh === true ) {

		object.computeBoundingBox();

		return object.boundingBox;

	}

	return geometryBox( object.geometry );

}

function instancedBox( mesh ) {

	const version = mesh.instanceMatrix.version;
	let entry = instanceBoxes.get( mesh );

	if ( entry === undefined || entry.version !== version || entry.count !== mesh.count ) {

		entry = { version, count: mesh.count, box: new Box3() };

		const box = geometryBox( mesh.geometry );

		for ( let i = 0; i < mesh.count; i ++ ) {

			mesh.getMatrixAt( i, _matrix );
			entry.box.union( _instance.copy( box ).applyMatrix4( _matrix ) );

		}

		instanceBoxes.set( mesh, entry );

	}

	return entry.box;

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
