//! Many jobs at once, in little memory: all end, and all memory comes back.

use super::*;
use crate::batch::scenes::estimate;
use std::time::Duration;

const SCENE: &str = r#"<scene version="3.0.0"><integrator type="path"/>
  <sensor type="perspective"><float name="fov" value="40"/><film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/></film></sensor>
  <shape type="rectangle"/><emitter type="constant"/></scene>"#;
const SCENES: usize = 5;

/// A store for so many bytes more than the process has, and its scenes.
fn store(directory: &std::path::Path, room: u64) -> (Store, Vec<SceneKey>) {
    let key = |i: usize| {
        let path = directory.join(format!("{i}.xml"));
        std::fs::write(&path, SCENE).unwrap();
        SceneKey {
            path,
            defines: Vec::new(),
        }
    };
    let store = Store::new(0, Workers::new(1).unwrap(), Backend::default());
    let base = store.ledger.lock().used;
    let ledger = Ledger::new(base + room, base);
    let store = Store {
        ledger: Arc::new(ledger),
        ..store
    };
    (store, (0..SCENES).map(key).collect())
}

#[test]
fn many_jobs_in_little_memory_all_end() {
    let directory = tempfile::tempdir().unwrap();
    // A scene takes a little more than a megabyte: two fit, five do not.
    let (store, keys) = store(directory.path(), 5 << 19);
    let base = store.ledger.lock().used;
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let (store, keys) = (&store, &keys);
            scope.spawn(move || {
                for i in 0..60 {
                    let key = &keys[(i / 3 + thread) % SCENES];
                    let admitted = store.admit(key, |_| Ok(1 << 16), &|| false).unwrap();
                    assert!(store.ledger.lock().used <= base + (5 << 19));
                    assert_eq!(admitted.loaded.scene.meshes.len(), 1);
                }
            });
        }
    });
    let state = store.ledger.lock();
    assert_eq!(state.active, 0);
    assert!(!state.loading && state.next_in_line.is_none());
    let scenes: u64 = state
        .scenes
        .values()
        .map(|slot| estimate::of_scene(&slot.scene.scene))
        .sum();
    assert_eq!(state.used, base + scenes);
}

#[test]
fn what_never_fits_fails_and_harms_nobody() {
    let directory = tempfile::tempdir().unwrap();
    let (store, keys) = store(directory.path(), 5 << 19);
    let held = store.admit(&keys[0], |_| Ok(1000), &|| false).unwrap();
    std::thread::scope(|scope| {
        let large = scope.spawn(|| store.admit(&keys[1], |_| Ok(1 << 30), &|| false).err());
        std::thread::sleep(Duration::from_millis(50));
        drop(held);
        let failure = large.join().unwrap().unwrap();
        assert_eq!(failure.code(), 4, "{failure}");
    });
    assert!(store.admit(&keys[2], |_| Ok(1000), &|| false).is_ok());
    // Who gives up while waiting is not waited for.
    let held = store.admit(&keys[0], |_| Ok(1 << 20), &|| false).unwrap();
    assert!(store.admit(&keys[0], |_| Ok(1 << 20), &|| true).is_err());
    drop(held);
    assert!(store.admit(&keys[1], |_| Ok(1000), &|| false).is_ok());
}
