/* One small interface over OpenImageIO 2.4 and later, which is C++ and throws.
 *
 * A picture is the first of the images in its file, at its full size: level 0 of mip maps. */
#ifndef WARPATH_OIIO_SHIM_H
#define WARPATH_OIIO_SHIM_H

typedef struct WarpathPicture WarpathPicture;

typedef struct WarpathPictureSpec {
    unsigned width;
    unsigned height;
    unsigned channels; /* that are read: 3, red, green and blue; or 1, grey; or 0: neither is in the file */
    int is_integer; /* stored as integers, whatever is read from them */
    int is_linear; /* said so by the file */
} WarpathPictureSpec;

/* What OpenImageIO says of a failure; or, where `channels` is 0, the names of those in the file. */
typedef struct WarpathPictureMessage {
    char text[512];
} WarpathPictureMessage;

/* Null on failure. `path` is in the encoding of the file system. */
WarpathPicture *warpath_picture_open(const char *path, WarpathPictureSpec *spec,
                                     WarpathPictureMessage *message);
/* Fills width * height * channels floats, row by row from the top, integers divided by the largest one.
 * Non-zero on failure. */
int warpath_picture_read(WarpathPicture *picture, float *samples, WarpathPictureMessage *message);
void warpath_picture_close(WarpathPicture *picture);

#endif
