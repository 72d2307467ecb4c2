//! Deformation problems built from nothing: ex-rotated elasticity with inversion-free blocks on squares and bars.

use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Cone, Constraints, Engine, Objective, Problem, Term};

/// Smallest eigenvalue asked of `sym(Rᵀ F)`.
pub const EPS: f64 = 1e-3;
/// Weight of the soft handles.
const ALPHA: f64 = 1e4;

/// A problem with places of its unknowns.
pub struct Scene {
    pub problem: Problem,
    pub coordinates: Vec<[f64; 3]>,
    /// The rest positions as a vector of unknowns.
    pub rest: Vec<f64>,
}

/// A mesh of simplices in dimension D, N = D + 1 vertices each.
pub struct Simplices<const D: usize, const N: usize> {
    pub points: Vec<[f64; D]>,
    pub cells: Vec<[u32; N]>,
}

/// The unit square, `side` x `side` squares, each cut into four triangles.
pub fn square(side: usize) -> Simplices<2, 3> {
    let h = 1.0 / side as f64;
    let mut points = Vec::new();
    for j in 0..=side {
        points.extend((0..=side).map(|i| [i as f64 * h, j as f64 * h]));
    }
    let centres = points.len();
    let mut cells = Vec::new();
    for j in 0..side {
        for i in 0..side {
            let a = (j * (side + 1) + i) as u32;
            let (b, c, d) = (a + 1, a + 2 + side as u32, a + 1 + side as u32);
            let centre = (centres + j * side + i) as u32;
            cells.extend([[a, b, centre], [b, c, centre], [c, d, centre], [d, a, centre]]);
            points.push([(i as f64 + 0.5) * h, (j as f64 + 0.5) * h]);
        }
    }
    Simplices { points, cells }
}

/// A bar of cubes with edge 1 / across, `along` x `across` x `across` cubes of six tetrahedra.
pub fn bar(along: usize, across: usize) -> Simplices<3, 4> {
    let h = 1.0 / across as f64;
    let index = |i: usize, j: usize, k: usize| (i * (across + 1) * (across + 1) + j * (across + 1) + k) as u32;
    let mut points = Vec::new();
    for i in 0..=along {
        for j in 0..=across {
            points.extend((0..=across).map(|k| [i as f64 * h, j as f64 * h, k as f64 * h]));
        }
    }
    let mut cells = Vec::new();
    for i in 0..along {
        for j in 0..across {
            for k in 0..across {
                for axes in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
                    let mut corner = [i, j, k];
                    let mut cell = [index(i, j, k); 4];
                    for (step, axis) in axes.into_iter().enumerate() {
                        corner[axis] += 1;
                        cell[step + 1] = index(corner[0], corner[1], corner[2]);
                    }
                    cells.push(cell);
                }
            }
        }
    }
    Simplices { points, cells }
}

fn determinant<const D: usize>(a: &[[f64; D]; D]) -> f64 {
    if D == 2 {
        a[0][0] * a[1][1] - a[0][1] * a[1][0]
    } else {
        (0..3).map(|j| a[0][j] * (a[1][(j + 1) % 3] * a[2][(j + 2) % 3] - a[1][(j + 2) % 3] * a[2][(j + 1) % 3])).sum()
    }
}

impl<const D: usize, const N: usize> Simplices<D, N> {
    /// Gradients of the vertices' hat functions and the area or volume of a cell.
    pub fn gradients(&self, cell: usize) -> ([[f64; D]; N], f64) {
        let corner = |v: usize| self.points[self.cells[cell][v] as usize];
        let edges: [[f64; D]; D] = std::array::from_fn(|v| std::array::from_fn(|a| corner(v + 1)[a] - corner(0)[a]));
        let size = determinant(&edges);
        // Cramer: the gradient g_v solves edges g_v = unit vector v.
        let mut gradients = [[0.0; D]; N];
        for v in 0..D {
            for a in 0..D {
                let mut minor = edges;
                for (row, line) in minor.iter_mut().enumerate() {
                    line[a] = f64::from(u8::from(row == v));
                }
                gradients[v + 1][a] = determinant(&minor) / size;
                gradients[0][a] -= gradients[v + 1][a];
            }
        }
        (gradients, size.abs() / if D == 2 { 2.0 } else { 6.0 })
    }

    fn centre(&self, cell: usize) -> [f64; D] {
        std::array::from_fn(|a| self.cells[cell].iter().map(|&v| self.points[v as usize][a]).sum::<f64>() / N as f64)
    }

    /// The deformation problem.
    ///
    /// # Arguments
    /// * `rotation`: R of each cell; `handle`: where a vertex is pulled to.
    pub fn scene(
        &self,
        rotation: impl Fn(usize) -> [[f64; D]; D],
        handle: impl Fn(usize) -> Option<[f64; D]>,
    ) -> Scene {
        let n = self.points.len() * D;
        let rows_each = D * (D + 1) / 2;
        let (mut form, mut rows) = (Vec::new(), Vec::new());
        let (mut linear, mut offset) = (vec![0.0; n], Vec::new());
        let mut constant = 0.0;
        for cell in 0..self.cells.len() {
            let (gradients, size) = self.gradients(cell);
            let r = rotation(cell);
            constant += 0.5 * size * D as f64;
            let unknown = |v: usize, a: usize| self.cells[cell][v] * D as u32 + a as u32;
            for u in 0..N {
                for a in 0..D {
                    linear[unknown(u, a) as usize] -= size * (0..D).map(|b| r[a][b] * gradients[u][b]).sum::<f64>();
                    for v in 0..N {
                        let value = size * (0..D).map(|b| gradients[u][b] * gradients[v][b]).sum::<f64>();
                        form.push((unknown(u, a), unknown(v, a), value));
                    }
                    let mut row = (cell * rows_each) as u32;
                    for i in 0..D {
                        for j in 0..=i {
                            let value = 0.5 * (r[a][i] * gradients[u][j] + r[a][j] * gradients[u][i]);
                            rows.push((row, unknown(u, a), if i == j { value } else { value * 2f64.sqrt() }));
                            row += 1;
                        }
                    }
                }
            }
            for i in 0..D {
                offset.extend((0..=i).map(|j| if i == j { -EPS } else { 0.0 }));
            }
        }
        for vertex in 0..self.points.len() {
            if let Some(place) = handle(vertex) {
                for (a, d) in place.into_iter().enumerate() {
                    let unknown = vertex * D + a;
                    form.push((unknown as u32, unknown as u32, 2.0 * ALPHA));
                    linear[unknown] -= 2.0 * ALPHA * d;
                    constant += ALPHA * d * d;
                }
            }
        }
        let matrix = CsrMatrix::from_triplets(offset.len(), n, &rows).unwrap();
        let cones = vec![if D == 2 { Cone::Psd2(self.cells.len()) } else { Cone::Psd3(self.cells.len()) }];
        let coordinates = self.points.iter().flat_map(|p| {
            let place: [f64; 3] = std::array::from_fn(|a| p.get(a).copied().unwrap_or(0.0));
            std::iter::repeat_n(place, D)
        });
        Scene {
            coordinates: coordinates.collect(),
            rest: self.points.iter().flatten().copied().collect(),
            problem: Problem {
                objective: Objective { terms: vec![Term::Matrix(CsrMatrix::from_triplets(n, n, &form).unwrap())], linear, constant },
                fixed: vec![None; n],
                constraints: Constraints { matrix, offset, cones },
            },
        }
    }
}

fn turn(angle: f64) -> [[f64; 2]; 2] {
    [[angle.cos(), -angle.sin()], [angle.sin(), angle.cos()]]
}

/// Weights of a handle: 1 inside, 0 on the border, harmonic between.
fn weights(mesh: &Simplices<2, 3>, radius: f64) -> Vec<f64> {
    let mut triplets = Vec::new();
    for cell in 0..mesh.cells.len() {
        let (g, size) = mesh.gradients(cell);
        for u in 0..3 {
            for v in 0..3 {
                let value = size * (g[u][0] * g[v][0] + g[u][1] * g[v][1]);
                triplets.push((mesh.cells[cell][u], mesh.cells[cell][v], value));
            }
        }
    }
    let n = mesh.points.len();
    let matrix = CsrMatrix::from_triplets(n, n, &triplets).unwrap();
    let objective = Objective { terms: vec![Term::Matrix(matrix)], linear: vec![0.0; n], constant: 0.0 };
    let fixed: Vec<Option<f64>> = mesh.points.iter().map(|p| place(*p, radius).map(|inside| f64::from(u8::from(inside)))).collect();
    Engine::new(&objective, None, None).unwrap().minimise(&objective, &fixed).unwrap().x
}

/// Whether a point belongs to the disc (true), the border (false) or neither.
fn place(p: [f64; 2], radius: f64) -> Option<bool> {
    if (p[0] - 0.5).hypot(p[1] - 0.5) <= radius + 1e-9 {
        Some(true)
    } else {
        p.iter().any(|&c| c <= 0.0 || c >= 1.0).then_some(false)
    }
}

/// A disc in the unit square moved and turned, the border kept.
pub fn disc(side: usize, radius: f64, (degrees, shift): (f64, [f64; 2])) -> Scene {
    let mesh = square(side);
    let weight = weights(&mesh, radius);
    let angle = degrees.to_radians();
    let rotation = |cell: usize| turn(angle * mesh.cells[cell].iter().map(|&v| weight[v as usize]).sum::<f64>() / 3.0);
    let whole = turn(angle);
    let handle = |vertex: usize| {
        let p = mesh.points[vertex];
        place(p, radius).map(|inside| {
            if inside {
                let (x, y) = (p[0] - 0.5, p[1] - 0.5);
                std::array::from_fn(|a| 0.5 + shift[a] + whole[a][0] * x + whole[a][1] * y)
            } else {
                p
            }
        })
    };
    mesh.scene(rotation, handle)
}

/// FINDINGS' square: a disc of radius 0.15 moved by (0.2, 0.08) and turned by 60 degrees.
pub fn quad(side: usize) -> Scene {
    disc(side, 0.15, (60.0, [0.2, 0.08]))
}

/// A disc of radius 0.1 turned.
pub fn swirl(side: usize, degrees: f64) -> Scene {
    disc(side, 0.1, (degrees, [0.0, 0.0]))
}

/// A bar bent by an angle in its plane, both ends held.
pub fn bent(along: usize, across: usize, degrees: f64) -> Scene {
    let mesh = bar(along, across);
    let length = along as f64 / across as f64;
    let angle = degrees.to_radians();
    let turn = |t: f64| [[t.cos(), -t.sin(), 0.0], [t.sin(), t.cos(), 0.0], [0.0, 0.0, 1.0]];
    let handle = |vertex: usize| {
        let p = mesh.points[vertex];
        if p[0] <= 0.0 {
            Some(p)
        } else if p[0] >= length - 1e-9 {
            // The end of an arc three quarters as long as the bar: its inner side is squeezed.
            let (radius, r) = (0.75 * length / angle, turn(angle));
            Some([radius * angle.sin() + r[0][1] * (p[1] - 0.5), 0.5 + radius * (1.0 - angle.cos()) + r[1][1] * (p[1] - 0.5), p[2]])
        } else {
            None
        }
    };
    mesh.scene(|cell| turn(angle * mesh.centre(cell)[0] / length), handle)
}

/// A square in which one triangle is asked to turn against all others.
pub fn turned_triangle(side: usize, degrees: f64) -> (Scene, usize) {
    let mesh = square(side);
    let chosen = mesh.cells.len() / 2 + 2 * side;
    let handle = |vertex: usize| place(mesh.points[vertex], 0.0).map(|_| mesh.points[vertex]);
    let scene = mesh.scene(|cell| turn(if cell == chosen { degrees.to_radians() } else { 0.0 }), handle);
    (scene, chosen)
}
