/* Linked into ThreadSanitizer builds alone, in the place of GDAL's own. OpenCV calls it once, before the first image that
   it reads or writes, though nothing here reads through GDAL; and it takes two locks in both orders, which the sanitizer
   reports. OpenCV calls it under a lock of its own, so that no deadlock can come of it. */
void GDALAllRegister(void);
void GDALAllRegister(void) {}
