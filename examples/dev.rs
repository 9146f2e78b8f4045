use glam::*;
use warpath::methods::*;
use warpath::scene::*;
struct Quiet;
impl Progress for Quiet { fn advance(&self,_:u64,_:u64){} fn cancelled(&self)->bool{false} }
fn ply(name:&str)->(Vec<Vec3>,Vec<[u32;3]>){
  let b=std::fs::read(format!("/work/shared/peers/meshes/{name}")).unwrap();
  let h=b.windows(11).position(|w|w==b"end_header\n").unwrap()+11;
  let head=String::from_utf8_lossy(&b[..h]).to_string();
  let num=|k:&str| head.lines().find(|l|l.starts_with(k)).unwrap().split(' ').nth(2).unwrap().parse::<usize>().unwrap();
  let (nv,nf)=(num("element vertex"),num("element face"));
  let f=|o:usize|f32::from_le_bytes(b[o..o+4].try_into().unwrap());
  let u=|o:usize|u32::from_le_bytes(b[o..o+4].try_into().unwrap());
  let v=(0..nv).map(|i|vec3(f(h+12*i),f(h+12*i+4),f(h+12*i+8))).collect();
  let fo=h+12*nv;
  let t=(0..nf).map(|i|[u(fo+13*i+1),u(fo+13*i+5),u(fo+13*i+9)]).collect();
  (v,t)
}
fn npy(p:&str)->Vec<f32>{ let b=std::fs::read(p).unwrap(); let n=u16::from_le_bytes([b[8],b[9]]) as usize+10; b[n..].chunks(4).map(|c|f32::from_le_bytes(c.try_into().unwrap())).collect() }
fn scene(name:&str,filter:Filter)->(Scene,SceneDifferential){
  let mut s=Scene{meshes:vec![],materials:vec![],area_lights:vec![],environment:None,sensors:vec![],integrator:Integrator{max_depth:2,rr_depth:100,hide_emitters:false},warnings:vec![],hash:0};
  fn add(s:&mut Scene,id:&str,f:&str,r:Rgb,le:Option<Rgb>){ let (p,t)=ply(f); let m=s.materials.len(); s.materials.push(Material{key:id.into(),reflectance:r,two_sided:true}); let l=le.map(|radiance|{s.area_lights.push(AreaLight{mesh:s.meshes.len(),radiance,key:id.into()}); s.area_lights.len()-1}); s.meshes.push(Mesh{id:id.into(),positions:p,triangles:t,normals:Normals::Flat,material:m,area_light:l}); }
  let (o,t,fov);let mut dir=vec3(0.,0.,0.); let mut cam=None; let mut obj=usize::MAX;
  match name {
   "s1_sphere"=>{ add(&mut s,"obj","s1_sphere.ply",[0.2,0.5,0.1],None); s.environment=Some(Environment{key:"env".into(),radiance:[1.0;3]}); o=vec3(0.3,-6.0,0.4); t=Vec3::ZERO; fov=30f32; dir=vec3(1.,0.,0.3); obj=0; }
   "s2_shadow"=>{ add(&mut s,"floor","floor.ply",[0.6;3],None); add(&mut s,"obj","s2_occ.ply",[0.5;3],None); add(&mut s,"light","light_top.ply",[0.0;3],Some([10.0;3])); o=vec3(0.,-3.2,1.6);t=Vec3::ZERO;fov=40.; dir=vec3(1.,0.2,0.);obj=1; }
   "s5_camera"=>{ add(&mut s,"floor","floor.ply",[0.6;3],None); add(&mut s,"obj","s5_objs.ply",[0.7,0.4,0.2],None); add(&mut s,"light","light_top.ply",[0.0;3],Some([10.0;3])); o=vec3(0.2,-4.,2.);t=vec3(0.,0.,0.3);fov=36.; cam=Some(CameraDifferential{translation:vec3(1.,0.,0.),..Default::default()}); }
   _=>panic!() }
  let z=(t-o).normalize(); let x=Vec3::Z.cross(z).normalize(); let y=z.cross(x);
  s.sensors.push(Sensor{id:"cam".into(),to_world:Affine3A::from_mat3_translation(Mat3::from_cols(x,y,z),o),x_fov_rad:fov.to_radians(),near_clip:0.01,far_clip:1000.,principal_point_offset:Vec2::ZERO,film:Film{width:128,height:128,crop_offset:[0,0],crop_size:[128,128],filter,sample_border:true},sample_count:64,seed:0});
  let mut d=SceneDifferential::none(&s); d.camera=cam; if obj!=usize::MAX { d.positions[obj]=Some(vec![dir;s.meshes[obj].positions.len()]); }
  (s,d)
}
fn main(){
  let a:Vec<String>=std::env::args().collect();
  let name=&a[1]; let spp:u32=a[3].parse().unwrap(); let runs:u64=a[4].parse().unwrap();
  let (fname,filter)=if a[2]=="box"{("box",Filter::Box{radius:0.5})}else{("gauss",Filter::Gaussian{stddev:0.5})};
  let method=if a.get(5).map(|s|s=="interior").unwrap_or(false){Method::Interior}else{Method::Reparam};
  let (s,d)=scene(name,filter);
  let r=npy(&format!("/work/shared/peers/ref/{name}.{fname}.npy")); let rse=npy(&format!("/work/shared/peers/ref/{name}.{fname}.stderr.npy")); let rimg=npy(&format!("/work/shared/peers/ref/{name}.{fname}.img.npy"));
  let rms=(r.iter().map(|x|(*x as f64).powi(2)).sum::<f64>()/r.len() as f64).sqrt();
  let mut sum=vec![0f64;r.len()]; let mut sq=vec![0f64;r.len()]; let mut se2=0f64; let mut isum=vec![0f64;r.len()];
  let t=std::time::Instant::now(); let mut mse=0.0;
  for k in 0..runs {
    let st=Settings{spp,seed:k+1,threads:2,max_depth:2,rr_depth:100,hide_emitters:false,sensor:0,resolution:None,method,standard_error:std::env::var("NOSE").is_err()};
    let g=forward(&s,&st,&d,&Quiet).unwrap();
    if k==0 { eprintln!("{:?}",g.statistics); }
    for (i,x) in g.gradient.pixels.iter().flatten().enumerate(){ let x=*x as f64; sum[i]+=x; sq[i]+=x*x; mse+=(x-r[i] as f64).powi(2); }
    for (i,x) in g.image.pixels.iter().flatten().enumerate(){ isum[i]+=*x as f64; }
    if let Some(e)=&g.stderr { se2+=e.pixels.iter().flatten().map(|x|(*x as f64).powi(2)).sum::<f64>(); }
    if k==0 { std::fs::write("/tmp/g.raw", g.gradient.pixels.iter().flatten().flat_map(|x|x.to_le_bytes()).collect::<Vec<u8>>()).unwrap(); }
  }
  let n=runs as f64; let sec=t.elapsed().as_secs_f64()/n;
  let err=(mse/n/r.len() as f64).sqrt()/rms;
  let var:f64=(0..r.len()).map(|i|(sq[i]-sum[i]*sum[i]/n)/(n-1.0)).sum::<f64>()/r.len() as f64;
  let bias2:f64=(0..r.len()).map(|i|(sum[i]/n-r[i] as f64).powi(2)).sum::<f64>()/r.len() as f64 - var/n;
  let proj=(0..r.len()).map(|i|sum[i]/n*r[i] as f64).sum::<f64>()/r.iter().map(|x|(*x as f64).powi(2)).sum::<f64>();
  let refse=(rse.iter().filter(|x|x.is_finite()).map(|x|(*x as f64).powi(2)).sum::<f64>()/rse.len() as f64).sqrt()/rms;
  let mut z=vec![]; for i in 0..r.len(){ let v=(sq[i]-sum[i]*sum[i]/n)/(n-1.0)/n+(rse[i] as f64).powi(2); if v>0.0&&v.is_finite(){ z.push((sum[i]/n-r[i] as f64)/v.sqrt()); } }
  let zv=z.iter().map(|x|x*x).sum::<f64>()/z.len() as f64; let big=z.iter().filter(|x|x.abs()>4.0).count();
  let irel={let m=rimg.iter().map(|x|(*x as f64).powi(2)).sum::<f64>(); ((0..r.len()).map(|i|(isum[i]/n-rimg[i] as f64).powi(2)).sum::<f64>()/m).sqrt()};
  std::fs::write("/tmp/mean.raw", sum.iter().flat_map(|x|((x/n) as f32).to_le_bytes()).collect::<Vec<u8>>()).unwrap();
  println!("{name} {fname} spp {spp} runs {runs}: {sec:.3} s  err {err:.4} spread {:.4} bias {:.4} (ref se {refse:.4}) proj {proj:.4} eff {:.1} se-ratio {:.3} z2 {zv:.2} |z|>4: {big}/{} image {irel:.5}", var.sqrt()/rms, bias2.signum()*bias2.abs().sqrt()/rms, 1.0/(err*err*sec), (var/(se2/n/r.len() as f64)).sqrt(), z.len());
}
