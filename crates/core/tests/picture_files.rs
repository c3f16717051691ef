//! Saving and loading pictures, with everything that may go wrong on the way.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, Layer, LayerAttributes,
    Text, Vec2, WritableImage,
};
use image::{DynamicImage, GrayImage, ImageBuffer, Luma, LumaA, Rgba};
use lancer_core::image::{Image, ImageError, ImageSize, WriteError, load, save, write_atomically};
use tempfile::{TempDir, tempdir};

/// Colours from black to beyond white.
fn picture_of(size: ImageSize) -> Image {
    let channel = |i: usize| (i * i) as f32 / 8000.0;
    let pixels =
        (0..size.pixels()).map(|i| [channel(3 * i), channel(3 * i + 1), channel(3 * i + 2)]);
    Image::from_pixels(size, pixels.collect())
}

fn picture() -> Image {
    picture_of(ImageSize::new(7, 5))
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A folder holding one file, `name`, of the bytes "old".
fn folder_with_old(name: &str) -> (TempDir, PathBuf) {
    let folder = tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, "old").unwrap();
    (folder, path)
}

/// The message names the file and holds the words of the cure.
fn assert_tells(error: &dyn Error, path: &Path, cure: &str) {
    let message = error.to_string();
    assert!(message.contains(&path.display().to_string()), "{message}");
    assert!(message.contains(cure), "{message}");
}

#[test]
fn png_keeps_the_display_levels() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.PNG");
    for exposure_ev in [0.0, -1.5] {
        save(&path, &picture(), exposure_ev).unwrap();
        let loaded = load(&path).unwrap();
        assert_eq!(loaded.size(), picture().size());
        assert_eq!(loaded.to_srgb8(0.0), picture().to_srgb8(exposure_ev));
    }
    assert_eq!(names(folder.path()), ["a.PNG"]);
}

#[test]
fn every_8_bit_level_survives_a_round_trip() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("levels.png");
    GrayImage::from_fn(256, 1, |x, _| Luma([x as u8])).save(&path).unwrap();
    let expected: Vec<[u8; 3]> = (0..=255).map(|level| [level; 3]).collect();
    assert_eq!(load(&path).unwrap().to_srgb8(0.0), expected);
}

#[test]
fn exr_keeps_every_bit_and_ignores_the_exposure() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let mut pixels = picture().pixels().to_vec();
    pixels[0] = [f32::NAN, -f32::NAN, f32::from_bits(0x7fa0_1234)];
    pixels[1] = [f32::INFINITY, f32::NEG_INFINITY, -0.0];
    pixels[2] = [f32::MIN_POSITIVE, f32::from_bits(1), f32::MAX];
    let image = Image::from_pixels(picture().size(), pixels);
    save(&path, &image, 3.0).unwrap();
    let loaded = load(&path).unwrap();
    let bits =
        |image: &Image| image.pixels().iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>();
    assert_eq!(loaded.size(), image.size());
    assert_eq!(bits(&loaded), bits(&image));
}

/// An EXR file of 3×2 pixels: in channel `k` of the list the pixel `i` is 10 k + i.
fn write_exr(path: &Path, channels: &[&str]) {
    let channel = |(k, &name): (usize, &&str)| {
        let samples = (0..6).map(|i| (10 * k + i) as f32).collect();
        AnyChannel::new(Text::from(name), FlatSamples::F32(samples))
    };
    let channels = AnyChannels::sort(channels.iter().enumerate().map(channel).collect());
    let attributes = LayerAttributes::default();
    let layer = Layer::new(Vec2(3, 2), attributes, Encoding::UNCOMPRESSED, channels);
    ExrImage::from_layer(layer).write().to_file(path).unwrap();
}

#[test]
fn the_picture_of_an_exr_is_found_among_its_channels() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.exr");
    for (channels, wanted) in [
        (&["R", "G", "B"][..], [0.0, 10.0, 20.0]),
        (&["A", "B", "G", "R", "Z"], [30.0, 20.0, 10.0]),
        // A luminance is grey, one layer is the picture, and of several it is the one without a name.
        (&["Y"], [0.0, 0.0, 0.0]),
        (&["A", "Y"], [10.0, 10.0, 10.0]),
        (&["beauty.R", "beauty.G", "beauty.B"], [0.0, 10.0, 20.0]),
        (&["depth.Z", "view.beauty.R", "view.beauty.G", "view.beauty.B"], [10.0, 20.0, 30.0]),
        (&["mirror.R", "mirror.G", "mirror.B", "R", "G", "B"], [30.0, 40.0, 50.0]),
    ] {
        write_exr(&path, channels);
        let loaded = load(&path).unwrap();
        assert_eq!(loaded.size(), ImageSize::new(3, 2));
        let pixels = (0..6).map(|i| wanted.map(|first: f32| first + i as f32));
        assert_eq!(loaded.pixels(), pixels.collect::<Vec<_>>(), "{channels:?}");
    }
}

#[test]
fn an_exr_without_a_picture_tells_what_it_has() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(&path, &["matte.R", "matte.G", "matte.B", "mirror.R", "mirror.G", "mirror.B"]);
    let told = "which of its layers is the picture: matte, mirror? Keep one, or rename";
    assert_tells(&load(&path).unwrap_err(), &path, told);
    for (channels, told) in [
        (&["Z"][..], "no picture in its channels Z; save it with channels R, G and B, or Y"),
        (&["G", "R", "wR"], "no picture in its channels G, R, wR;"),
        // Luminance and chroma: grey would be another picture.
        (&["BY", "RY", "Y"], "no picture in its channels BY, RY, Y;"),
    ] {
        write_exr(&path, channels);
        assert_tells(&load(&path).unwrap_err(), &path, told);
    }
}

#[test]
fn grey_alpha_and_16_bit_pictures_are_read() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.png");
    // Level 32768 of 65535 and level 188 of 255 are linear 0.2140482… and 0.5028864… (mpmath).
    let (half, high) = (0.214_048_2_f32, 0.502_886_5_f32);
    let pictures: [(DynamicImage, [f32; 3]); 4] = [
        (ImageBuffer::from_pixel(2, 3, Luma([188_u8])).into(), [high; 3]),
        (ImageBuffer::from_pixel(2, 3, LumaA([188_u8, 7])).into(), [high; 3]),
        (ImageBuffer::from_pixel(2, 3, Luma([32768_u16])).into(), [half; 3]),
        (ImageBuffer::from_pixel(2, 3, Rgba([32768_u16, 0, 65535, 9])).into(), [half, 0.0, 1.0]),
    ];
    for (picture, expected) in pictures {
        picture.save(&path).unwrap();
        let loaded = load(&path).unwrap();
        assert_eq!(loaded.size(), ImageSize::new(2, 3));
        for (channel, expected) in loaded.pixels()[5].into_iter().zip(expected) {
            assert!((channel - expected).abs() < 1e-6, "{:?}: {channel}", picture.color());
        }
    }
}

#[test]
fn unknown_extensions_are_refused_with_the_known_ones() {
    let (folder, path) = folder_with_old("picture.jpg");
    for name in ["picture.jpg", "picture", ".png", "png", "a.png.txt", ""] {
        let path = folder.path().join(name);
        for error in [save(&path, &picture(), 0.0).unwrap_err(), load(&path).unwrap_err()] {
            assert!(matches!(error, ImageError::UnknownExtension { .. }), "{error:?}");
            assert_tells(&error, &path, ".png (sRGB) or .exr (linear)");
        }
    }
    assert_eq!(fs::read(path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["picture.jpg"]);
}

#[test]
fn an_exposure_that_is_no_number_is_refused() {
    let (_folder, path) = folder_with_old("a.png");
    for exposure_ev in [f64::NAN, f64::INFINITY] {
        let error = save(&path, &picture(), exposure_ev).unwrap_err();
        assert_tells(&error, &path, "number of stops");
    }
    assert_eq!(fs::read(path).unwrap(), b"old");
}

#[test]
fn a_missing_folder_is_named() {
    let (folder, file) = folder_with_old("file");
    for missing in [folder.path().join("no/such"), file] {
        let path = missing.join("a.png");
        let error = save(&path, &picture(), 0.0).unwrap_err();
        assert!(matches!(error, ImageError::Write(WriteError::MissingFolder { .. })), "{error:?}");
        assert_tells(&error, &path, &format!("no folder `{}`; create it", missing.display()));
    }
    assert_eq!(names(folder.path()), ["file"]);
}

#[test]
fn a_folder_is_no_picture() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("folder.png");
    fs::create_dir(&path).unwrap();
    let error = save(&path, &picture(), 0.0).unwrap_err();
    assert!(matches!(error, ImageError::Write(WriteError::IsFolder { .. })), "{error:?}");
    assert_tells(&error, &path, "it is a folder; name a file in it");
    let error = load(&path).unwrap_err();
    assert!(matches!(error, ImageError::IsFolder { .. }), "{error:?}");
    assert_tells(&error, &path, "it is a folder; name a picture in it");
    assert_eq!(names(folder.path()), ["folder.png"]);
    assert_eq!(names(&path), [""; 0]);
}

#[test]
fn a_write_protected_file_is_not_replaced() {
    let (folder, path) = folder_with_old("a.png");
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    let error = save(&path, &picture(), 0.0).unwrap_err();
    assert!(matches!(error, ImageError::Write(WriteError::WriteProtected { .. })), "{error:?}");
    assert_tells(&error, &path, "make it writable");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn a_failed_rename_leaves_nothing_over() {
    // The bytes reach the temporary file; the rename fails, as names have at most 255 bytes.
    let folder = tempdir().unwrap();
    let path = folder.path().join("x".repeat(300) + ".png");
    let error = save(&path, &picture(), 0.0).unwrap_err();
    assert!(matches!(error, ImageError::Write(WriteError::Io { .. })), "{error:?}");
    assert_tells(&error, &path, "cannot write");
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_file_is_replaced_whole() {
    let (folder, path) = folder_with_old("a.csv");
    write_atomically(&path, b"x").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"x");
    write_atomically(&path, b"").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"");
    assert_eq!(names(folder.path()), ["a.csv"]);
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    use std::os::unix::net::UnixListener;

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o7777
    }

    #[test]
    fn a_new_file_has_the_usual_permissions_and_a_replaced_one_its_own() {
        let (folder, usual) = folder_with_old("usual");
        let path = folder.path().join("a.png");
        save(&path, &picture(), 0.0).unwrap();
        assert_eq!(mode(&path), mode(&usual), "as fs::write makes it");
        for own in [0o600, 0o666] {
            fs::set_permissions(&path, PermissionsExt::from_mode(own)).unwrap();
            save(&path, &picture(), 0.0).unwrap();
            assert_eq!(mode(&path), own);
        }
    }

    #[test]
    fn a_read_only_folder_stays_as_it_is() {
        let (folder, path) = folder_with_old("a.png");
        fs::set_permissions(folder.path(), PermissionsExt::from_mode(0o555)).unwrap();
        let result = save(&path, &picture(), 0.0);
        fs::set_permissions(folder.path(), PermissionsExt::from_mode(0o755)).unwrap();
        assert_eq!(names(folder.path()), ["a.png"]);
        match result {
            Ok(()) => println!("skipped: this user (root?) may write to read-only folders"),
            Err(error) => {
                assert_tells(&error, &path, "read-only; choose another");
                assert_eq!(fs::read(&path).unwrap(), b"old");
            }
        }
    }

    #[test]
    fn a_link_is_followed() {
        let (folder, path) = folder_with_old("a.csv");
        let link = folder.path().join("link");
        symlink(&path, &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    /// By a chain of links, relative and absolute, to a file that is not there yet.
    #[test]
    fn a_link_to_nothing_is_filled() {
        let folder = tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("far")).unwrap();
        symlink("far/second", path("first")).unwrap();
        symlink(path("far/new.csv"), path("far/second")).unwrap();
        write_atomically(path("first"), b"new").unwrap();
        assert_eq!(fs::read(path("far/new.csv")).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["far", "first"]);
        assert_eq!(names(&path("far")), ["new.csv", "second"]);
        assert!(fs::symlink_metadata(path("first")).unwrap().is_symlink());

        symlink("circle", path("circle")).unwrap();
        let error = write_atomically(path("circle"), b"new").unwrap_err();
        assert!(error.source().unwrap().to_string().contains("circle; name a file"), "{error:?}");
        assert!(fs::symlink_metadata(path("circle")).unwrap().is_symlink());
    }

    #[test]
    fn a_socket_or_device_is_not_replaced() {
        let folder = tempdir().unwrap();
        let path = folder.path().join("socket.exr");
        let _listener = UnixListener::bind(&path).unwrap();
        let error = save(&path, &picture(), 0.0).unwrap_err();
        assert!(matches!(error, ImageError::Write(WriteError::NotAFile { .. })), "{error:?}");
        assert_tells(&error, &path, "name an ordinary file");
        assert!(fs::metadata(&path).unwrap().file_type().is_socket());
        assert_eq!(names(folder.path()), ["socket.exr"]);
    }

    /// One ends at once and one never does, but neither begins as a picture.
    #[test]
    fn devices_are_no_pictures() {
        let folder = tempdir().unwrap();
        for (name, device) in ["/dev/null", "/dev/zero"].into_iter().enumerate() {
            for extension in ["png", "exr"] {
                let path = folder.path().join(format!("{name}.{extension}"));
                symlink(device, &path).unwrap();
                assert_tells(&load(&path).unwrap_err(), &path, "it is damaged");
            }
        }
    }

    /// Needs a folder on a nearly full disk of at most 1 MiB, for instance (as root)
    /// `mount -t tmpfs -o size=64k tmpfs DIR`, and `LANCER_SMALL_DISK=DIR`.
    #[test]
    #[ignore = "needs a small disk in LANCER_SMALL_DISK"]
    fn a_full_disk_leaves_the_old_picture() {
        let folder = PathBuf::from(std::env::var_os("LANCER_SMALL_DISK").unwrap());
        let path = folder.join("a.exr");
        save(&path, &picture(), 0.0).unwrap();
        let large = picture_of(ImageSize::new(512, 512));
        let error = save(&path, &large, 0.0).unwrap_err();
        assert_tells(&error, &path, "the disk is full; free some space");
        assert_eq!(load(&path).unwrap(), picture());
        assert_eq!(names(&folder), ["a.exr"]);
        fs::remove_file(path).unwrap();
    }
}

#[test]
fn a_missing_picture_is_named() {
    let (folder, file) = folder_with_old("file");
    for path in [folder.path().join("no.png"), folder.path().join("no/no.exr"), file.join("a.png")]
    {
        let error = load(&path).unwrap_err();
        assert!(matches!(error, ImageError::Missing { .. }), "{error:?}");
        assert_tells(&error, &path, "there is no picture");
    }
}

#[test]
fn other_files_are_no_pictures() {
    let folder = tempdir().unwrap();
    let png = folder.path().join("a.png");
    let exr = folder.path().join("a.exr");
    save(&png, &picture(), 0.0).unwrap();
    save(&exr, &picture(), 0.0).unwrap();
    let (png_bytes, exr_bytes) = (fs::read(&png).unwrap(), fs::read(&exr).unwrap());
    for (path, bytes) in [(&png, &exr_bytes), (&exr, &png_bytes)] {
        for bytes in [bytes.as_slice(), b"", b"not a picture\n"] {
            fs::write(path, bytes).unwrap();
            assert_tells(&load(path).unwrap_err(), path, "it is damaged");
        }
    }
}

#[test]
fn truncated_and_damaged_pictures_give_errors_and_no_panics() {
    let folder = tempdir().unwrap();
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        save(&path, &picture(), 0.0).unwrap();
        let whole = fs::read(&path).unwrap();
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            if let Err(error) = load(&path) {
                assert_tells(&error, &path, "it is damaged");
            } else {
                // Only the last checksum of a PNG may be missing: every pixel is there.
                assert!(name == "a.png" && length + 4 >= whole.len(), "{name}: {length} bytes");
            }
        }
        for at in 0..whole.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = whole.clone();
                damaged[at] ^= flip;
                fs::write(&path, damaged).unwrap();
                if let Err(error) = load(&path) {
                    assert_tells(&error, &path, "");
                }
            }
        }
    }
}

#[test]
fn a_header_that_promises_too_much_is_refused() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.exr");
    save(&path, &picture(), 0.0).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    // The attribute's name and type, its length, then the corners x, y of a box.
    let attribute = b"displayWindow\0box2i\0\x10\0\0\0";
    let at = bytes.windows(attribute.len()).position(|bytes| bytes == attribute).unwrap();
    let far_corner = at + attribute.len() + 8;
    // The corner is the last pixel of the window.
    for (x, y, told) in [
        (29_999_i32, 29_999_i32, "a picture of 30000x30000 is too large"),
        (i32::MAX / 2, 100, "window size exceeding integer maximum"),
        (11_999, 11_999, "1728000000 bytes, the maximum is 536870912"),
    ] {
        bytes[far_corner..][..4].copy_from_slice(&x.to_le_bytes());
        bytes[far_corner + 4..][..4].copy_from_slice(&y.to_le_bytes());
        fs::write(&path, &bytes).unwrap();
        assert_tells(&load(&path).unwrap_err(), &path, told);
    }
}

/// Width, height, bits, kind of colour and the checksum (by zlib) of a PNG's header, which is right in
/// all but its size; the last would unpack to 64 million pixels of 12 bytes from a file of some KiB.
#[test]
fn a_png_of_absurd_size_is_refused_before_it_is_unpacked() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.png");
    save(&path, &picture(), 0.0).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    for (width, height, bits, color, checksum, told) in [
        (30_000_u32, 30_000_u32, 8, 2, 0xe945_6fed_u32, "a picture of 30000x30000 is too large"),
        (0x7fff_ffff, 0x7fff_ffff, 16, 6, 0x4459_d725, "make it"),
        (0, 5, 8, 2, 0xe424_7af6, "it is damaged"),
        (16_384, 16_384, 1, 0, 0x81b3_2d29, "3221225472 bytes, the maximum is 536870912"),
        (8_000, 8_000, 8, 0, 0x239a_f228, "768000000 bytes, the maximum is 536870912"),
    ] {
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        (bytes[24], bytes[25]) = (bits, color);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        fs::write(&path, &bytes).unwrap();
        assert_tells(&load(&path).unwrap_err(), &path, told);
    }
}
