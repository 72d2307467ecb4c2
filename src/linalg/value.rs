//! The numbers that a factor may be made of.

use faer::traits::RealField;

/// A floating-point type that matrices can be factored in: `f64`, or `f32` for half the memory where refinement follows.
pub trait Value: RealField + Copy + sealed::Sealed {
    /// The nearest number of this type.
    fn of(value: f64) -> Self;

    /// The same number in double precision.
    fn get(self) -> f64;
}

impl Value for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn get(self) -> f64 {
        self
    }
}

impl Value for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }

    fn get(self) -> f64 {
        f64::from(self)
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for f32 {}
}
