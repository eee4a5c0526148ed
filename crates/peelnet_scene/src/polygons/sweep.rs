//! Triangulation of large polygons in n log n steps: a sweep from left to right cuts the polygon into monotone pieces (de Berg et al.,
//! Computational Geometry, chapter 3), each of which is triangulated while the sweep passes it.

use std::{cmp::Ordering, collections::BTreeMap};

type Point = [f64; 2];

/// Areas of triangles add up to the polygon's, but for rounding.
const AREA_TOLERANCE: f64 = 1e-6;

/// Triangles of a counter-clockwise polygon, as indices of its vertices; `None` of one that meets itself.
pub(super) fn triangulate(points: &[Point]) -> Option<Vec<[usize; 3]>> {
    let n = points.len();
    // Edges without length have no direction.
    let names: Vec<usize> = (0..n)
        .filter(|&i| points[i] != points[(i + 1) % n])
        .collect();
    if names.len() < 3 {
        return None;
    }
    let own: Vec<Point> = names.iter().map(|&i| points[i]).collect();
    let mut order: Vec<usize> = (0..own.len()).collect();
    order.sort_unstable_by(|&a, &b| compare(own[a], own[b]).then(a.cmp(&b)));
    let mut rank = vec![0; own.len()];
    for (r, &i) in order.iter().enumerate() {
        rank[i] = r;
    }
    let mut sweep = Sweep {
        rank,
        status: BTreeMap::new(),
        made: Made {
            points: own,
            triangles: Vec::with_capacity(n),
        },
    };
    for i in order {
        sweep.pass(i)?;
    }
    let made = sweep.made;
    let all: f64 = made.triangles.iter().map(|t| made.turn(*t).abs()).sum();
    let exact = signed_area(&made.points);
    let is_whole = sweep.status.is_empty() && (all - exact).abs() <= AREA_TOLERANCE * exact;
    let triangles = made.triangles.into_iter();
    is_whole.then(|| triangles.map(|t| t.map(|i| names[i])).collect())
}

/// Twice the area of a polygon.
fn signed_area(points: &[Point]) -> f64 {
    let [x, y] = points[0];
    let edges = points.windows(2);
    edges
        .map(|e| (e[0][0] - x) * (e[1][1] - y) - (e[1][0] - x) * (e[0][1] - y))
        .sum()
}

/// From left to right, then upwards.
fn compare(a: Point, b: Point) -> Ordering {
    a.partial_cmp(&b).unwrap_or(Ordering::Equal)
}

/// Twice the area of a triangle: positive where c lies to the left of a → b.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// An edge that runs to the right, so that the polygon lies above it. Edges that the sweep line meets are ordered upwards.
#[derive(Clone, Copy)]
struct Edge {
    left: Point,
    right: Point,
    index: usize,
}

impl Ord for Edge {
    fn cmp(&self, other: &Self) -> Ordering {
        // The one that begins farther to the left spans the beginning of the other.
        if compare(self.left, other.left) == Ordering::Greater {
            return other.cmp(self).reverse();
        }
        let above = |p: Point| turn(self.left, self.right, p).partial_cmp(&0.0);
        let other_is_above = match above(other.left) {
            Some(Ordering::Equal) | None => above(other.right).unwrap_or(Ordering::Equal),
            Some(side) => side,
        };
        // An edge above this one makes this the lesser.
        other_is_above.reverse().then(self.index.cmp(&other.index))
    }
}

impl PartialOrd for Edge {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Edge {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Edge {}

/// What the sweep line meets of the polygon between two of its edges.
struct Region {
    low: Piece,
    /// Where two regions met last: the upper one's piece.
    high: Option<Piece>,
}

/// A monotone piece: the vertices of one side that no triangle has cut off yet, behind one of the other side.
struct Piece {
    stack: Vec<usize>,
    /// Whether they are of the upper side.
    upper: bool,
}

impl Piece {
    fn new(first: usize) -> Self {
        Self {
            stack: vec![first],
            upper: false,
        }
    }
}

/// Triangles so far.
struct Made {
    points: Vec<Point>,
    triangles: Vec<[usize; 3]>,
}

impl Made {
    fn turn(&self, t: [usize; 3]) -> f64 {
        let [a, b, c] = t.map(|i| self.points[i]);
        turn(a, b, c)
    }

    /// Adds a triangle of two neighbours of a side and a vertex to the right of them.
    fn push(&mut self, a: usize, b: usize, v: usize, upper: bool) {
        self.triangles
            .push(if upper { [b, a, v] } else { [a, b, v] });
    }

    /// Adds the next vertex of a side to a piece.
    fn add(&mut self, piece: &mut Piece, v: usize, upper: bool) {
        if piece.upper != upper && piece.stack.len() > 1 {
            let last = self.fan(piece, v);
            piece.stack.push(last);
        } else {
            while let [.., a, b] = piece.stack[..] {
                let t = if upper { [b, a, v] } else { [a, b, v] };
                if self.turn(t) <= 0.0 {
                    break;
                }
                self.triangles.push(t);
                piece.stack.pop();
            }
        }
        piece.stack.push(v);
        piece.upper = upper;
    }

    /// Ends a piece in its last vertex.
    fn finish(&mut self, mut piece: Piece, v: usize) {
        self.fan(&mut piece, v);
    }

    /// Cuts off all of a piece's stack from a vertex of the other side. Returns the last of the stack.
    fn fan(&mut self, piece: &mut Piece, v: usize) -> usize {
        for i in 1..piece.stack.len() {
            self.push(piece.stack[i - 1], piece.stack[i], v, piece.upper);
        }
        let last = piece.stack[piece.stack.len() - 1];
        piece.stack.clear();
        last
    }

    /// The piece that goes on where a region's lower edge meets a vertex.
    fn meet_below(&mut self, region: Region, v: usize) -> Piece {
        let mut piece = match region.high {
            None => region.low,
            Some(high) => {
                self.finish(region.low, v);
                high
            }
        };
        self.add(&mut piece, v, false);
        piece
    }

    /// The same where its upper edge meets one.
    fn meet_above(&mut self, region: &mut Region, v: usize) {
        if let Some(high) = region.high.take() {
            self.finish(high, v);
        }
        self.add(&mut region.low, v, true);
    }
}

struct Sweep {
    /// When a vertex is passed.
    rank: Vec<usize>,
    /// The regions that the sweep line meets, by their lower edges.
    status: BTreeMap<Edge, Region>,
    made: Made,
}

impl Sweep {
    fn edge(&self, index: usize) -> Edge {
        let points = &self.made.points;
        Edge {
            left: points[index],
            right: points[(index + 1) % points.len()],
            index,
        }
    }

    fn insert(&mut self, index: usize, low: Piece) {
        let edge = self.edge(index);
        self.status.insert(edge, Region { low, high: None });
    }

    /// Passes a vertex; `None` where the polygon meets itself.
    fn pass(&mut self, i: usize) -> Option<()> {
        let n = self.rank.len();
        let (before, after) = ((i + n - 1) % n, (i + 1) % n);
        let is_convex = self.made.turn([before, i, after]) >= 0.0;
        let is_left = |k: usize| self.rank[k] < self.rank[i];
        match (is_left(before), is_left(after)) {
            (false, false) if is_convex => self.insert(i, Piece::new(i)),
            (false, false) => self.split(i)?,
            (true, true) if is_convex => {
                let Region { low, high } = self.status.remove(&self.edge(before))?;
                self.made.finish(low, i);
                if let Some(high) = high {
                    self.made.finish(high, i);
                }
            }
            (true, true) => {
                let upper = self.status.remove(&self.edge(before))?;
                let upper = self.made.meet_below(upper, i);
                let (made, region) = self.around(i)?;
                made.meet_above(region, i);
                region.high = Some(upper);
            }
            (true, false) => {
                let region = self.status.remove(&self.edge(before))?;
                let piece = self.made.meet_below(region, i);
                self.insert(i, piece);
            }
            (false, true) => {
                let (made, region) = self.around(i)?;
                made.meet_above(region, i);
            }
        }
        Some(())
    }

    /// The region whose lower edge is the first below a vertex.
    fn around(&mut self, i: usize) -> Option<(&mut Made, &mut Region)> {
        let place = self.made.points[i];
        let probe = Edge {
            left: place,
            right: place,
            index: usize::MAX,
        };
        let (_, region) = self.status.range_mut(..probe).next_back()?;
        Some((&mut self.made, region))
    }

    /// A vertex that divides a region in two: it is joined with the region's last vertex.
    fn split(&mut self, i: usize) -> Option<()> {
        let (made, region) = self.around(i)?;
        let upper = match region.high.take() {
            Some(mut high) => {
                made.add(&mut high, i, false);
                made.add(&mut region.low, i, true);
                high
            }
            None => {
                let mut other = Piece::new(*region.low.stack.last()?);
                // The piece goes on at the side of its last vertex, another begins at the other side.
                let goes_up = !region.low.upper;
                if goes_up {
                    std::mem::swap(&mut other, &mut region.low);
                }
                made.add(&mut region.low, i, true);
                made.add(&mut other, i, false);
                other
            }
        };
        self.insert(i, upper);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_core::random::Random;
    use std::f64::consts::TAU;

    /// The polygon is covered once: n − 2 triangles, none turned over, whose areas add up (which `triangulate` checks).
    fn covers(points: &[Point]) {
        let triangles = triangulate(points).expect("is simple");
        assert_eq!(triangles.len(), points.len() - 2);
        for t in triangles {
            let [a, b, c] = t.map(|i| points[i]);
            assert!(turn(a, b, c) >= -1e-12, "{t:?}");
        }
    }

    fn ring(n: usize, mut radius: impl FnMut(usize) -> f64) -> Vec<Point> {
        let at = |i: usize| {
            let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
            let r = radius(i);
            [r * cos, r * sin]
        };
        (0..n).map(at).collect()
    }

    #[test]
    fn simple_polygons_are_covered() {
        covers(&[[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]]);
        covers(&[[0., 0.], [2., 1.], [0., 2.], [1., 1.]]);
        // Collinear vertices on every side.
        covers(&[
            [0., 0.],
            [1., 0.],
            [2., 0.],
            [2., 1.],
            [2., 2.],
            [1., 2.],
            [0., 2.],
            [0., 1.],
        ]);
        let mut random = Random::new(3, &[]);
        for n in [5, 50, 500] {
            for _ in 0..100 {
                covers(&ring(n, |_| 0.1 + f64::from(random.unit())));
            }
        }
        // A comb with a tooth at every second vertex, and a band that winds seven times.
        let teeth = (0..99)
            .rev()
            .map(|i| [f64::from(i), if i % 2 == 0 { 1.0 } else { 50.0 }]);
        covers(
            &[[0.0, 0.0], [98.0, 0.0]]
                .into_iter()
                .chain(teeth)
                .collect::<Vec<_>>(),
        );
        let arm = |i: i32, r: f64| {
            let (sin, cos) = (TAU * f64::from(i) / 60.0).sin_cos();
            let r = r + f64::from(i) / 60.0;
            [r * cos, r * sin]
        };
        let out = (0..420).map(|i| arm(i, 1.4));
        covers(
            &out.chain((0..420).rev().map(|i| arm(i, 1.0)))
                .collect::<Vec<_>>(),
        );
    }

    #[test]
    fn what_meets_itself_is_not_covered() {
        assert_eq!(
            triangulate(&[[0., 0.], [2., 2.], [2., 0.], [0., 2.5]]),
            None
        );
        assert_eq!(triangulate(&[[1., 1.]; 9]), None);
        let mut random = Random::new(5, &[]);
        for _ in 0..100 {
            let mut any = || f64::from((random.unit() * 8.0).floor());
            let points: Vec<Point> = (0..40).map(|_| [any(), any()]).collect();
            // Whatever it is, it ends.
            triangulate(&points);
        }
    }
}
