extern "C" {
#include "oiio_shim.h"
}

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

using namespace OIIO;

struct WarpathPicture {
    std::unique_ptr<ImageInput> input;
    int channels;
};

static void say(WarpathPictureMessage *message, const std::string &text)
{
    std::snprintf(message->text, sizeof message->text, "%s", text.c_str());
}

/* Nothing may be thrown through C. */
template <typename Result, typename Do> static Result guarded(WarpathPictureMessage *message, Result failed, Do go)
{
    try {
        return go();
    } catch (const std::exception &e) {
        say(message, e.what());
    } catch (...) {
        say(message, "an unknown exception");
    }
    return failed;
}

/* How many channels from the first on are a colour. */
static int colour_channels(const ImageSpec &spec)
{
    if (spec.nchannels >= 3 && spec.channel_name(0) == "R" && spec.channel_name(1) == "G" &&
        spec.channel_name(2) == "B")
        return 3;
    return spec.nchannels == 1 || (spec.nchannels == 2 && spec.channel_name(0) == "Y") ? 1 : 0;
}

WarpathPicture *warpath_picture_open(const char *path, WarpathPictureSpec *spec, WarpathPictureMessage *message)
{
    return guarded<WarpathPicture *>(message, nullptr, [&]() -> WarpathPicture * {
        ImageSpec config;
        config.attribute("oiio:UnassociatedAlpha", 1); /* colours as stored, not multiplied by alpha */
        std::unique_ptr<ImageInput> input = ImageInput::open(path, &config);
        if (!input) {
            say(message, OIIO::geterror());
            return nullptr;
        }
        const ImageSpec &found = input->spec();
        if (found.deep || found.depth > 1) {
            say(message, found.deep ? "deep data is no picture" : "a volume is no picture");
            return nullptr;
        }
        const int channels = colour_channels(found);
        const std::string space = found.get_string_attribute("oiio:ColorSpace");
        spec->width = (unsigned)found.width;
        spec->height = (unsigned)found.height;
        spec->channels = (unsigned)channels;
        spec->is_integer = !found.format.is_floating_point();
        /* `linear`, and `lin_rec709` and its like of later versions */
        spec->is_linear = Strutil::istarts_with(space, "lin") || Strutil::iequals(space, "scene_linear");
        if (channels == 0) say(message, Strutil::join(found.channelnames, ", "));
        return new WarpathPicture { std::move(input), channels };
    });
}

int warpath_picture_read(WarpathPicture *picture, float *samples, WarpathPictureMessage *message)
{
    return guarded(message, 1, [&] {
        ImageInput &input = *picture->input;
        input.geterror(); /* forgets */
        /* Strips missing from a TIFF file are an error and yet a success, in black. */
        if (input.read_image(0, 0, 0, picture->channels, TypeDesc::FLOAT, samples) && !input.has_error())
            return 0;
        say(message, input.geterror());
        return 1;
    });
}

void warpath_picture_close(WarpathPicture *picture)
{
    delete picture;
}
