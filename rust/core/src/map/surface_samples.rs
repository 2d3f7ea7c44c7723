//! Samples of the surface, evenly spread over each link, and enough of them on small links too. Beforehand, a contact is as
//! likely on each link as on any other, and on a link as likely on each square metre as on any other: people touch, and
//! obstacles stop, fingers and flanges far more often than by their area.

use crate::error::{Error, Result};
use crate::robot::Robot;
use crate::surface::SurfacePoint;
use crate::torque::{PlaceBlock, LANES};

/// So many points are drawn for one that is kept: those farthest from each other.
const DRAWN: usize = 6;
const SEED: u64 = 0;

/// The samples of one link.
#[derive(Debug, Clone)]
pub(super) struct LinkSamples {
    /// Index into the robot's links.
    pub link: usize,
    pub places: Vec<SurfacePoint>,
    /// Area that each stands for (m^2).
    pub areas: Vec<f64>,
    /// Prior probability of each, and its logarithm.
    pub priors: Vec<f64>,
    pub log_priors: Vec<f64>,
    /// The same places, the last one repeated to fill a block.
    pub blocks: Vec<PlaceBlock>,
    /// Blocks of all links before it.
    pub first: usize,
}

/// The samples of a robot.
#[derive(Debug, Clone)]
pub(super) struct SurfaceSamples {
    pub links: Vec<LinkSamples>,
    /// Of all links (m^2).
    pub area: f64,
    pub count: usize,
    /// By link of the robot: logarithm of the prior probability of a square metre of it.
    log_densities: Vec<f64>,
}

impl SurfaceSamples {
    /// About `count` samples over the wanted links, the more the larger a link is, in proportion to the root of its area.
    ///
    /// # Errors
    /// [`Error::Input`] where none of the surface is exposed.
    pub fn new(robot: &Robot, wanted: &[usize], count: usize) -> Result<Self> {
        let surface = |index: usize| robot.links()[index].surface.as_ref();
        let areas: Vec<f64> = wanted
            .iter()
            .map(|&index| surface(index).map_or(0.0, |surface| surface.exposed_area()))
            .collect();
        let mut log_densities = vec![f64::NEG_INFINITY; robot.links().len()];
        let exposed = areas.iter().filter(|area| **area > 0.0).count() as f64;
        for (&link, area) in wanted.iter().zip(&areas).filter(|(_, area)| **area > 0.0) {
            log_densities[link] = -(exposed * area).ln();
        }
        let roots: f64 = areas.iter().map(|area| area.sqrt()).sum();
        let mut links = Vec::with_capacity(wanted.len());
        for (&link, &area) in wanted.iter().zip(&areas) {
            let own = ((area.sqrt() / roots * count as f64).round() as usize).max(1);
            let drawn = surface(link).map_or(vec![], |surface| surface.sample(own * DRAWN, SEED));
            if !drawn.is_empty() {
                let first = links.last().map_or(0, |last: &LinkSamples| last.first + last.blocks.len());
                links.push(LinkSamples {
                    first,
                    ..LinkSamples::spread(link, &drawn, own, area, log_densities[link])
                });
            }
        }
        if links.is_empty() {
            return Err(Error::input(
                "robot",
                "none of the surface is exposed; a contact map needs a part of it exposed",
            ));
        }
        Ok(SurfaceSamples {
            area: areas.iter().sum(),
            count: links.iter().map(|link| link.places.len()).sum(),
            links,
            log_densities,
        })
    }

    /// Logarithm of the prior probability of a piece of a link (an index into the robot's) of an area (m^2).
    #[inline]
    pub fn log_prior(&self, link: usize, area: f64) -> f64 {
        area.ln() + self.log_densities[link]
    }

    /// Edge of the patch that a sample stands for, on average (m).
    pub fn spacing(&self) -> f64 {
        (self.area / self.count as f64).sqrt()
    }
}

impl LinkSamples {
    /// `count` of the points drawn, each the farthest from those before (Gonzalez 1985); each stands for the points that are
    /// nearest to it.
    fn spread(link: usize, drawn: &[SurfacePoint], count: usize, area: f64, log_density: f64) -> Self {
        let mut nearest = vec![(f64::INFINITY, 0); drawn.len()];
        let mut places = Vec::with_capacity(count);
        let mut next = 0;
        while places.len() < count.min(drawn.len()) {
            let place = drawn[next];
            for ((distance, owner), other) in nearest.iter_mut().zip(drawn) {
                let apart = (other.point - place.point).norm_squared();
                if apart < *distance {
                    (*distance, *owner) = (apart, places.len());
                }
            }
            places.push(place);
            let farthest = (0..drawn.len()).max_by(|&a, &b| nearest[a].0.total_cmp(&nearest[b].0));
            next = farthest.unwrap_or(0);
        }
        let mut areas = vec![0.0; places.len()];
        nearest.iter().for_each(|(_, owner)| areas[*owner] += area / drawn.len() as f64);
        let blocks = places
            .chunks(LANES)
            .zip(areas.chunks(LANES))
            .map(|(places, areas)| block(places, areas))
            .collect();
        let log_priors: Vec<f64> = areas.iter().map(|area| area.ln() + log_density).collect();
        let priors = log_priors.iter().map(|log| log.exp()).collect();
        LinkSamples { link, places, areas, priors, log_priors, blocks, first: 0 }
    }
}

fn block(places: &[SurfacePoint], areas: &[f64]) -> PlaceBlock {
    let of = |k: usize| {
        let k = k.min(places.len() - 1);
        (places[k].point, places[k].normal, areas[k])
    };
    PlaceBlock::new(&std::array::from_fn(of))
}
