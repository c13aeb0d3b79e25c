//! The figures, as data: a new one is an entry.

use super::drawn;
use crate::failure::Failure;
use manylight_report::Drawing;
use std::path::Path;

/// A method in a figure.
#[derive(Clone, Copy)]
pub struct Shot {
    /// What it is called there.
    pub name: &'static str,
    /// As `compare` takes it: `vsl:paths=64,bound=none`.
    pub method: &'static str,
    /// Passes with `--quick`; eight times as many without.
    pub passes: u64,
}

const fn shot(name: &'static str, method: &'static str, passes: u64) -> Shot {
    Shot { name, method, passes }
}

/// SVG and a line below each, and a table.
pub type Drawn = (Vec<(Drawing, String)>, (Vec<String>, Vec<Vec<String>>));

/// What a figure shows.
#[derive(Clone, Copy)]
pub enum Content {
    /// Images by several methods, the truth first, and their errors.
    Images {
        /// Folder of `scenes/`.
        scene: &'static str,
        /// `name=value` for the scene file.
        defines: &'static [(&'static str, &'static str)],
        /// The truth, unless it is the first of the shots.
        truth: Shot,
        /// What is held against it.
        shots: &'static [Shot],
        /// So many frames of each ($frame = 0, 1, ..): how they flicker. 1: no animation.
        frames: u64,
    },
    /// Drawn from the parts themselves; it is given the folder of scenes.
    Drawn(fn(&Path) -> Result<Drawn, Failure>),
}

/// A figure.
pub struct Figure {
    /// Short: for `--only`, links and files.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What there is to be seen.
    pub caption: &'static str,
    /// What it shows.
    pub content: Content,
}

const NONE: &[(&str, &str)] = &[];

const fn images(
    scene: &'static str,
    defines: &'static [(&'static str, &'static str)],
    truth: Shot,
    shots: &'static [Shot],
) -> Content {
    Content::Images { scene, defines, truth, shots, frames: 1 }
}

/// All figures, in the order of the page.
pub static FIGURES: &[Figure] = &[
    Figure {
        name: "two-passes",
        title: "Instant radiosity in two passes",
        caption: "Light paths leave virtual point lights where they meet surfaces; then every pixel gathers from them. Direct light is \
                  sampled from the lamp, all other light comes from the virtual lights: each of the two alone, together, and with the \
                  lights of a single pass, whose shadows show that they are few.",
        content: images(
            "cornell-box",
            NONE,
            shot("paths", "path:spp=64", 6),
            &[
                shot("direct light", "instant-radiosity:direct=only", 16),
                shot("virtual lights alone", "instant-radiosity:min-depth=3", 12),
                shot("together", "instant-radiosity", 12),
                shot("one pass of 8 paths", "instant-radiosity:paths=8", 1),
            ],
        ),
    },
    Figure {
        name: "generators",
        title: "Four ways to put virtual lights",
        caption: "A room that is lit through a door left ajar: most lights of light paths light nothing that is seen. Rejection keeps \
                  those that bring the camera something, bidirectional instant radiosity finds some from the camera, Metropolis instant \
                  radiosity makes a chain of them; about as many are gathered in each.",
        content: images(
            "ajar",
            NONE,
            shot("paths", "path:spp=128", 4),
            &[
                shot("light paths", "instant-radiosity:paths=64", 8),
                shot("rejection", "rejection:paths=512,selectivity=8", 8),
                shot("bidirectional", "bidirectional-ir:paths=256,resampled=200", 8),
                shot("Metropolis", "metropolis-ir:paths=200", 8),
            ],
        ),
    },
    Figure {
        name: "splotches",
        title: "Splotches, and what a bound does about them",
        caption: "Where surfaces meet, cos cos / d^2 has no bound, and neither has the variance: single lights make splotches. Bounded, \
                  they are gone, and so is the light in the corner. Show the difference: red is too bright, blue too dark.",
        content: images(
            "corner",
            NONE,
            shot("paths", "path:spp=96", 4),
            &[
                shot("unbounded", "instant-radiosity:paths=128,bound=none", 2),
                shot("bounded", "instant-radiosity:paths=128,bound=0.5", 2),
            ],
        ),
    },
    Figure {
        name: "compensation",
        title: "What a bound takes, brought back",
        caption: "Kollig and Keller continue paths where the bound was at work, without bias; local lights let the pixels of a tile find \
                  lights for each other, without bias and with less noise; in screen space the image itself is asked, fast and biased.",
        content: images(
            "corner",
            NONE,
            shot("paths", "path:spp=96", 4),
            &[
                shot("bounded", "instant-radiosity:paths=128,bound=0.5", 4),
                shot("Kollig and Keller", "instant-radiosity:paths=128,bound=0.5,compensation=kollig-keller", 4),
                shot("local lights", "instant-radiosity:paths=128,bound=0.5,compensation=local", 4),
                shot("screen space", "instant-radiosity:paths=128,bound=0.5,compensation=screen-space", 4),
            ],
        ),
    },
    Figure {
        name: "spheres",
        title: "Virtual spherical lights, and four ways to sample them",
        caption: "Brushed steel and copper under indirect light. Point lights make spikes; bounded, they lose the gloss. Spheres blur \
                  both. Directions to a sphere are drawn evenly in its cone, by the receiver's lobe, by the light's, or by all together: \
                  only together is every combination of sharp and broad lobes without outliers.",
        content: images(
            "kitchen",
            NONE,
            shot("paths", "path:spp=96", 4),
            &[
                shot("points, unbounded", "instant-radiosity:paths=96,bound=none", 4),
                shot("points, contribution bounded", "instant-radiosity:paths=96,bound=auto,bound-of=contribution", 4),
                shot("spheres, all together", "vsl:paths=96,sphere-sampling=mis", 4),
                shot("spheres, cone", "vsl:paths=96,sphere-sampling=cone", 4),
                shot("spheres, receiver's lobe", "vsl:paths=96,sphere-sampling=receiver", 4),
                shot("spheres, light's lobe", "vsl:paths=96,sphere-sampling=light", 4),
            ],
        ),
    },
    Figure {
        name: "juice",
        title: "Ray lights against point lights: juice",
        caption: "A box of dense juice. Points at collisions are spots of 1/d^2 in the fog. As ray lights, the edges between them spread their \
                  light along a line; what is left is where lines meet surfaces and each other, and a bound takes that too.",
        content: images(
            "fruit-juice",
            NONE,
            shot("paths", "path:spp=96", 4),
            &[
                shot("points", "media-vpl:paths=32,bound=none", 6),
                shot("points, bounded", "media-vpl:paths=32", 6),
                shot("rays", "vrl:paths=32,bound=none", 4),
                shot("rays, bounded", "vrl:paths=32,bound=10", 4),
            ],
        ),
    },
    Figure {
        name: "smoke",
        title: "Ray lights against point lights: a smoky room",
        caption: "Wisps of smoke, lit through a window: few of the light paths get in, and most of the noise is that of the light through it.",
        content: images(
            "smoky-room",
            NONE,
            shot("paths", "path:spp=24", 3),
            &[
                shot("points", "media-vpl:paths=160,bound=none", 3),
                shot("points, bounded", "media-vpl:paths=160", 3),
                shot("rays", "vrl:paths=128,bound=none", 2),
                shot("rays, bounded", "vrl:paths=128,bound=10", 2),
            ],
        ),
    },
    Figure {
        name: "flicker",
        title: "Which of them flickers",
        caption: "Three frames of the juice, two passes each: the lights are new in every frame, while nothing but the lamp moves a little. How \
                  much pixels flicker from frame to frame stands in the table; the images are the first frame.",
        content: Content::Images {
            scene: "fruit-juice",
            defines: NONE,
            truth: shot("paths", "path:spp=64", 1),
            shots: &[
                shot("points", "media-vpl:paths=32,bound=none", 2),
                shot("points, bounded", "media-vpl:paths=32", 2),
                shot("rays", "vrl:paths=32,bound=none", 2),
                shot("rays, bounded", "vrl:paths=32,bound=10", 2),
            ],
            frames: 3,
        },
    },
    Figure {
        name: "phase-functions",
        title: "Drawing a point on the camera's ray where phase functions are sharp",
        caption: "A light beside a ray, in fog of Henyey and Greenstein's phase function: what counts is 1/d^2 times two phase functions. \
                  By angle alone 1/d^2 is met; a table of ten values over the angle meets their product.",
        content: Content::Drawn(drawn::phase_functions),
    },
    Figure {
        name: "light-tree",
        title: "A light tree and three cuts",
        caption: "Virtual lights of the Cornell box from above, as large as they are bright, and the clusters of the cut of ten that \
                  stochastic lightcuts makes at three points (crosses): fine where lights are near and bright, coarse where they are far.",
        content: Content::Drawn(drawn::light_tree),
    },
    Figure {
        name: "lightcuts",
        title: "Lightcuts against stochastic lightcuts at equal samples",
        caption: "The same lights, 24 shadow rays a point. Lightcuts asks one light that stands for its cluster, the same for all points of \
                  a pass: banding; stochastic lightcuts draws one for each point: noise, without bias. Noise goes with more passes, and the \
                  shared error of cuts only with new representatives.",
        content: images(
            "kitchen",
            NONE,
            shot("all lights", "instant-radiosity:paths=512,direct=virtual", 4),
            &[
                shot("lightcuts", "lightcuts:paths=512,max-cut=24,error=none", 2),
                shot("stochastic lightcuts", "stochastic-lightcuts:paths=512,cut=24", 2),
                shot("light-bvh", "light-bvh:paths=512,samples=24", 2),
            ],
        ),
    },
    Figure {
        name: "grids",
        title: "The levels of a lighting grid hierarchy, and how they blend",
        caption: "A ball of fire from the side: one light a block of voxels, and the averages on each level of the grid, as large as they \
                  are bright. Below, how much a level counts at a distance: at each distance the weights sum to one.",
        content: Content::Drawn(drawn::grids),
    },
    Figure {
        name: "fire",
        title: "A lighting grid hierarchy against path tracing",
        caption: "An explosion lights its own smoke and the floor, scattered once in all four: paths, the grid, the same lights by stochastic \
                  lightcuts, and few paths. Look at the difference too: lights of blocks and averages stand elsewhere than the fire, with \
                  other smoke before them.",
        content: images(
            "explosion",
            NONE,
            shot("paths", "path:max-depth=2,spp=64", 4),
            &[
                shot("grid hierarchy", "lgh:block=2", 6),
                shot("stochastic lightcuts", "lgh:block=2,lights=stochastic-lightcuts", 6),
                shot("few paths", "path:max-depth=2,spp=8", 4),
            ],
        ),
    },
    Figure {
        name: "scattering",
        title: "Single against multiple scattering",
        caption: "The explosion by paths that scatter once and by paths that scatter as often as they like: what methods of single \
                  scattering leave out.",
        content: images(
            "explosion",
            NONE,
            shot("multiple scattering", "path:spp=64", 4),
            &[shot("single scattering", "path:max-depth=2,spp=64", 4)],
        ),
    },
];
