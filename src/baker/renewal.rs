//! A scene that comes to need what was left out: its first light, its first texture, an object that begins to move.

use super::dark::nothing_to_bake;
use super::frames::Frames;
use super::memory::MemoryEstimate;
use super::setup::check_size;
use super::{Baker, Core, Running};
use crate::bvh::{Bvh, Motion};
use crate::error::{Error, Result};
use crate::scene::{Atlas, Scene};

impl Baker {
    /// Takes the scene as it is from now on: its lights and their number, sky, materials, textures, and which of its
    /// instances may move, may all be others than before. What it now needs is built, what it no longer needs is let go,
    /// and the light that has been gathered stays: the light map shows it at once, and where nothing has changed its
    /// accumulation goes on. What has changed leaves as after any other change. Instances, their meshes and their light-map
    /// coordinates stay as they are; movable instances that were taken out stay out. What frames cost, and where rays are
    /// aimed, is found out anew.
    ///
    /// It waits for the device and takes about as long as [`Baker::new`]: no frame of the baker is under way, and the light
    /// maps that [`Baker::light_map`] gave are the same as before. After an error all is as it was.
    ///
    /// # Errors
    /// As [`Baker::new`]; `InvalidSettings` without [`super::Mode::Frames`]; `InvalidScene` where the light map's layout is another.
    pub fn set_scene(&mut self, scene: &Scene) -> Result<()> {
        let Running::Frames(running) = &mut self.0 else {
            return Err(Error::settings("a bake at a stretch takes no other scene; one within frames does"));
        };
        let (core, frames) = &mut **running;
        frames.check_at_rest()?;
        let settings = core.settings.clone();
        check_size(scene)?;
        let atlas = Atlas::new(scene, settings.resolution)?;
        if atlas.touched_texels == 0 {
            return Err(Error::scene(nothing_to_bake(scene)));
        }
        if atlas != core.atlas {
            return Err(Error::scene(format!(
                "the light map of '{}' has another layout; allowed are the instances and light-map coordinates that the baker \
                 was made with",
                scene.name()
            )));
        }
        let estimate = MemoryEstimate::of_bake(scene, &atlas, &settings);
        estimate.check(atlas.size.to_array(), core.gpu.info())?;
        let mut bvh = Bvh::build_for(scene, &atlas, Motion::OfMovables)?;
        let statistics = core.statistics.clone();
        let features = estimate.features;
        let mut new = Core::new(&core.gpu, scene, &settings, &mut bvh, atlas, features, statistics, Some(core))?;
        let renewed = Frames::new(&mut new, scene, bvh, frames.settings(), settings.sampling)?;
        frames.renew(core, renewed, &new);
        *core = new;
        Ok(())
    }
}
