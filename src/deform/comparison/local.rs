//! Energies of one element as functions of its deformation gradient.

/// Value and two derivatives by the N = D² entries of F, row by row.
#[derive(Clone, Copy)]
pub(super) struct Local<const N: usize> {
    pub value: f64,
    pub gradient: [f64; N],
    pub hessian: [[f64; N]; N],
}

/// What an element contributes to the energy, its measure included.
pub(super) trait ElementEnergy<const D: usize, const N: usize>: Sync {
    /// Infinite where it is not defined.
    fn value(&self, element: usize, f: &[f64; N]) -> f64;

    /// Value, gradient, and a Hessian made positive semi-definite.
    fn expand(&self, element: usize, f: &[f64; N]) -> Local<N>;
}

/// `v (1/2 |F - R|² + nu/2 (trace(RᵀF) - D)²)`, on which all methods build.
pub(super) struct Elastic<'a> {
    pub measures: &'a [f64],
    pub rotations: &'a [[[f64; 3]; 3]],
    pub nu: f64,
}

impl Elastic<'_> {
    /// R of an element as the entries of F are stored.
    pub fn rotation<const D: usize, const N: usize>(&self, element: usize) -> [f64; N] {
        std::array::from_fn(|entry| self.rotations[element][entry / D][entry % D])
    }
}

impl<const D: usize, const N: usize> ElementEnergy<D, N> for Elastic<'_> {
    fn value(&self, element: usize, f: &[f64; N]) -> f64 {
        let r = self.rotation::<D, N>(element);
        let (mut square, mut trace) = (0.0, 0.0);
        for (f, r) in f.iter().zip(&r) {
            square += (f - r) * (f - r);
            trace += r * (f - r);
        }
        0.5 * self.measures[element] * (square + self.nu * trace * trace)
    }

    fn expand(&self, element: usize, f: &[f64; N]) -> Local<N> {
        let (r, v) = (self.rotation::<D, N>(element), self.measures[element]);
        let trace: f64 = f.iter().zip(&r).map(|(f, r)| r * (f - r)).sum();
        let gradient = std::array::from_fn(|i| v * (f[i] - r[i] + self.nu * trace * r[i]));
        let hessian = std::array::from_fn(|i| {
            std::array::from_fn(|j| v * (f64::from(u8::from(i == j)) + self.nu * r[i] * r[j]))
        });
        Local { value: <Self as ElementEnergy<D, N>>::value(self, element, f), gradient, hessian }
    }
}
