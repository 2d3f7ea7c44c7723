//! The misfit as a function of the force.

use nalgebra::{Matrix3, Vector3};

use super::ConePart;

/// Relative size of rounding errors of a Gram matrix: a force whose gain is below this share of the largest is not shown
/// by the torques.
const UNSHOWN: f64 = 1e-13;
/// Where a force is not shown, this share of the largest gain is added to all: small forces are preferred then. Gains
/// that are shown lose less by it than by rounding.
const RIDGE: f64 = 1e-12;
/// Steps of iterative refinement that take back what the ridge changed of gains that are shown.
const REFINEMENTS: usize = 2;
/// Share of its terms above which a gain is computed without the ridge.
const SHOWN: f64 = 1e-10;

/// Half the squared norm of what a force leaves over of the torques, but for a constant. Scaled so that the largest gain
/// and the largest product are one, in tangents that are not coupled with each other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Misfit {
    /// Squared norm of the torques of a unit force along the normal, and along each tangent.
    pub normal: f64,
    pub across: [f64; 2],
    /// Inner products of the torques along the tangents with those along the normal.
    pub coupling: [f64; 2],
    /// Inner products with the measured torques.
    pub product: f64,
    pub products: [f64; 2],
}

/// The turn about the normal to the tangents of a misfit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tangents {
    cos: f64,
    sin: f64,
}

impl Tangents {
    /// In which a symmetric matrix of two rows is diagonal (one rotation of Jacobi's), and its diagonal there.
    fn new(first: f64, coupling: f64, second: f64) -> (Self, [f64; 2]) {
        if coupling == 0.0 {
            return (Tangents { cos: 1.0, sin: 0.0 }, [first, second]);
        }
        let ratio = (second - first) / (2.0 * coupling);
        let tan = ratio.signum() / (ratio.abs() + (1.0 + ratio * ratio).sqrt());
        let cos = 1.0 / (1.0 + tan * tan).sqrt();
        (Tangents { cos, sin: tan * cos }, [first - tan * coupling, second + tan * coupling])
    }

    fn turn(&self, x: f64, y: f64) -> [f64; 2] {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }

    /// A force in the directions that were given.
    pub fn back(&self, [normal, x, y]: &[f64; 3]) -> Vector3<f64> {
        Vector3::new(*normal, self.cos * x + self.sin * y, self.cos * y - self.sin * x)
    }
}

impl Misfit {
    pub fn new(gram: &Matrix3<f64>, products: &Vector3<f64>) -> (Self, Tangents) {
        let (tangents, across) = Tangents::new(gram[(1, 1)], gram[(1, 2)], gram[(2, 2)]);
        let misfit = Misfit {
            normal: gram[(0, 0)].max(0.0),
            across: across.map(|gain| gain.max(0.0)),
            coupling: tangents.turn(gram[(0, 1)], gram[(0, 2)]),
            product: products[0],
            products: tangents.turn(products[1], products[2]),
        };
        (misfit, tangents)
    }

    /// The best force, unless that is none.
    pub fn best(&self, friction: f64) -> ([f64; 3], ConePart) {
        let is_inside = |[normal, x, y]: &[f64; 3]| *normal >= 0.0 && x.hypot(*y) <= friction * normal;
        let shown = self.pivot();
        let ridged = if shown.is_some() { *self } else { self.ridged() };
        let pivot = shown.unwrap_or_else(|| ridged.free_gain().max(RIDGE));
        let free = ridged.free(pivot);
        if is_inside(&free) {
            let refinements = if shown.is_some() { 0 } else { REFINEMENTS };
            let mut force = free;
            for _ in 0..refinements {
                force = Some(self.refined(&force, &ridged, pivot)).filter(is_inside).unwrap_or(force);
            }
            return (force, ConePart::Interior);
        }
        let (own, ridged) = (self.in_units_of(friction), ridged.in_units_of(friction));
        let direction = if friction > 0.0 { ridged.limit() } else { [1.0, 0.0] };
        let misfit = if own.shows(direction) { own } else { ridged };
        let [x, y] = if shown.is_some() { misfit.turned(direction) } else { misfit.improved(direction) };
        let (gain, product) = misfit.along([x, y]);
        let force = (product / gain).max(0.0);
        ([force, friction * force * x, friction * force * y], ConePart::Boundary)
    }

    /// Gain of a normal force beside which both tangents are free.
    fn free_gain(&self) -> f64 {
        let Misfit { normal, across, coupling, .. } = self;
        normal - coupling[0] * coupling[0] / across[0] - coupling[1] * coupling[1] / across[1]
    }

    /// The same; none where the torques do not show every force.
    fn pivot(&self) -> Option<f64> {
        let Misfit { normal, across, coupling, .. } = self;
        let most = across[0].max(across[1]);
        let beside = [coupling[0] / across[0], coupling[1] / across[1]];
        // Largest gain of the force that the torques show least, were no coupling to take from it.
        let apart = normal + most * (beside[0] * beside[0] + beside[1] * beside[1]);
        let gain = self.free_gain();
        (across[0].min(across[1]) > UNSHOWN * most && gain > UNSHOWN * apart).then_some(gain)
    }

    fn ridged(&self) -> Misfit {
        Misfit { normal: self.normal + RIDGE, across: self.across.map(|gain| gain + RIDGE), ..*self }
    }

    /// The best of all forces.
    fn free(&self, pivot: f64) -> [f64; 3] {
        let Misfit { across, coupling, product, products, .. } = self;
        let [x, y] = [0, 1].map(|i| products[i] / across[i]);
        let normal = (product - coupling[0] * x - coupling[1] * y) / pivot;
        let [x, y] = [0, 1].map(|i| (products[i] - coupling[i] * normal) / across[i]);
        [normal, x, y]
    }

    /// A step of iterative refinement towards the best of all forces.
    fn refined(&self, force: &[f64; 3], ridged: &Misfit, pivot: f64) -> [f64; 3] {
        let Misfit { normal, across, coupling, product, products } = self;
        let [n, x, y] = *force;
        let left = Misfit {
            product: product - (normal * n + coupling[0] * x + coupling[1] * y),
            products: [
                products[0] - (coupling[0] * n + across[0] * x),
                products[1] - (coupling[1] * n + across[1] * y),
            ],
            ..*ridged
        };
        let [dn, dx, dy] = left.free(pivot);
        [n + dn, x + dx, y + dy]
    }

    /// With tangential forces in units of the friction coefficient, in which the cone has the slope one.
    fn in_units_of(&self, friction: f64) -> Misfit {
        Misfit {
            across: self.across.map(|gain| gain * friction * friction),
            coupling: self.coupling.map(|coupling| coupling * friction),
            products: self.products.map(|product| product * friction),
            ..*self
        }
    }

    /// Gain and product of the force (1, x, y).
    pub fn along(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        let Misfit { normal, across, coupling, product, products } = self;
        let gain = normal + 2.0 * (coupling[0] * x + coupling[1] * y) + across[0] * x * x + across[1] * y * y;
        (gain, product + products[0] * x + products[1] * y)
    }

    /// Whether the torques show the force (1, x, y).
    fn shows(&self, [x, y]: [f64; 2]) -> bool {
        let terms = self.normal + self.across[0] * x * x + self.across[1] * y * y;
        self.along([x, y]).0 > SHOWN * terms
    }
}
